"""Plain values read from YAML and written as YAML, with PyYAML as ROS 2's own tools do."""

from __future__ import annotations

import sys
from collections import OrderedDict
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from operator import methodcaller
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from yaml import SafeDumper
    from yaml.nodes import Node

_DEEPEST: Final = 100
"""Mappings and lists inside each other; the deepest ROS message has a dozen."""


class YamlError(ValueError):
    """The text is no YAML, or YAML that is not taken; ``line`` counts from 1."""

    def __init__(self, problem: str, line: int) -> None:
        super().__init__(f"{problem} (line {line})")
        self.problem = problem
        self.line = line


def load(text: str) -> Any:
    """The value that a text stands for, with the types of YAML 1.1; None if it is empty.

    Only plain values are made, whatever the text's tags ask for.

    Raises:
        YamlError: it is no YAML, more than one document, nested too deeply, or holds an alias.
    """
    return _read(text, _loader(), methodcaller("get_single_data"))


def compose(text: str) -> Node | None:
    """The text's tree of nodes; a scalar has a tag only if it is written there.

    Raises:
        YamlError: as ``load``.
    """
    node: Node | None = _read(text, _untyped_loader(), methodcaller("get_single_node"))
    return node


def dump(values: Mapping[str, Any], *, flow_style: bool = False) -> str:
    """Dictionaries, lists and plain values in them as YAML, keys in order; on one line if ``flow_style``."""
    import yaml

    return yaml.dump(
        values,
        Dumper=_dumper(),
        allow_unicode=True,
        width=sys.maxsize,
        default_flow_style=flow_style,
        sort_keys=False,
    )


# Loading PyYAML takes longer than most programs that read no YAML would care to wait.


@cache
def _loader() -> Any:
    import yaml

    return getattr(yaml, "CSafeLoader", yaml.SafeLoader)


@cache
def _untyped_loader() -> Any:
    loader_class = _loader()

    class UntypedLoader(loader_class):  # type: ignore[misc, valid-type]
        """Leaves it to the reader to tell numbers and truth values from texts."""

        def resolve(self, kind: type[Node], value: str | None, implicit: object) -> str:
            return ""

    return UntypedLoader


@cache
def _dumper() -> type[SafeDumper]:
    from yaml import SafeDumper

    class Dumper(SafeDumper):
        """Writes the dictionaries that messages are made into as any other."""

    Dumper.add_representer(
        OrderedDict, lambda dumper, value: dumper.represent_mapping("tag:yaml.org,2002:map", value.items())
    )
    return Dumper


def _read(text: str, loader_class: Any, result_of: Callable[[Any], Any]) -> Any:
    import yaml

    def line(index: int) -> int:
        # libyaml finds the end of a text one line below its last.
        return min(index + 1, max(1, len(text.splitlines())))

    try:
        _check(text, loader_class)
        loader = loader_class(text)
        try:
            return result_of(loader)
        finally:
            loader.dispose()
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        problem = error.problem or error.context or "it is no YAML"
        raise YamlError(problem, 1 if mark is None else line(mark.line)) from None
    except yaml.reader.ReaderError as error:
        # The position counts characters or bytes, as the loader has it.
        before = text.encode(errors="replace")[: error.position]
        raise YamlError(error.reason, line(before.count(b"\n"))) from None
    except YamlError:
        raise
    except (ValueError, TypeError, LookupError, AttributeError, ArithmeticError):
        raise YamlError("a value does not fit its type", 1) from None


def _check(text: str, loader_class: Any) -> None:
    """Refuse what could make a small text into a huge or endless value."""
    import yaml

    depth = 0
    events: Iterator[Any] = yaml.parse(text, Loader=loader_class)
    for event in events:
        line = event.start_mark.line + 1
        if isinstance(event, yaml.AliasEvent):
            raise YamlError(f"the alias *{event.anchor} is not supported", line)
        if isinstance(event, yaml.CollectionStartEvent):
            depth += 1
        elif isinstance(event, yaml.CollectionEndEvent):
            depth -= 1
        if depth > _DEEPEST:
            # libyaml refuses what is nested far deeper in the same words.
            raise YamlError("exceeded maximum nesting depth", line)
