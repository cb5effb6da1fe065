"""Reads and writes plain values as YAML, with PyYAML as ROS 2's own tools do."""

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
    """The text is not YAML, or is refused; ``line`` counts from 1."""

    def __init__(self, problem: str, line: int) -> None:
        super().__init__(f"{problem} (line {line})")
        self.problem = problem
        self.line = line


def load(text: str) -> Any:
    """Parse a YAML document with the types of YAML 1.1; an empty text gives None.

    Tags in the text do not make other values than plain ones.

    Raises:
        YamlError: the text is not YAML, has more than one document, is nested too deeply, or has an alias.
    """
    return _read(text, _loader(), methodcaller("get_single_data"))


def compose(text: str) -> Node | None:
    """Parse a text into PyYAML's tree of nodes; a scalar has a tag only if the text writes one.

    Raises:
        YamlError: as ``load``.
    """
    node: Node | None = _read(text, _untyped_loader(), methodcaller("get_single_node"))
    return node


def dump(values: Mapping[str, Any], *, flow_style: bool = False) -> str:
    """Write dictionaries, lists and plain values as YAML, keys in order; on one line if ``flow_style``."""
    import yaml

    return yaml.dump(
        values,
        Dumper=_dumper(),
        allow_unicode=True,
        width=sys.maxsize,
        default_flow_style=flow_style,
        sort_keys=False,
    )


# PyYAML is imported when it is first used: the import takes long, and most programs read no YAML.


@cache
def _loader() -> Any:
    import yaml

    return getattr(yaml, "CSafeLoader", yaml.SafeLoader)


@cache
def _untyped_loader() -> Any:
    loader_class = _loader()

    class UntypedLoader(loader_class):  # type: ignore[misc, valid-type]
        """Leaves scalars without a type: the caller distinguishes numbers and booleans from texts."""

        def resolve(self, kind: type[Node], value: str | None, implicit: object) -> str:
            return ""

    return UntypedLoader


@cache
def _dumper() -> type[SafeDumper]:
    from yaml import SafeDumper

    class Dumper(SafeDumper):
        """Writes an ordered dictionary, which messages are turned into, as a plain mapping."""

    Dumper.add_representer(
        OrderedDict, lambda dumper, value: dumper.represent_mapping("tag:yaml.org,2002:map", value.items())
    )
    return Dumper


def _read(text: str, loader_class: Any, result_of: Callable[[Any], Any]) -> Any:
    import yaml

    def line(index: int) -> int:
        # libyaml places the end of a text one line below its last line.
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
        # The C loader's position counts bytes, the other one's counts characters.
        before = text.encode(errors="replace")[: error.position]
        raise YamlError(error.reason, line(before.count(b"\n"))) from None
    except YamlError:
        raise
    except (ValueError, TypeError, LookupError, AttributeError, ArithmeticError):
        raise YamlError("a value does not fit its type", 1) from None


def _check(text: str, loader_class: Any) -> None:
    """Refuse aliases and deep nesting, by which a small text can become a huge or endless value."""
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
            # libyaml has the same words for its own, far higher limit.
            raise YamlError("exceeded maximum nesting depth", line)
