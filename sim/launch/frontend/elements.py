"""Reads XML and YAML into the same tree: elements with attributes, and elements inside."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.parsers import expat

import yaml

from sim.launch.errors import LaunchError, LaunchFailure


@dataclass
class LaunchElement:
    """One element of a launch file, and the line that it begins on."""

    tag: str
    line: int
    attributes: dict[str, str] = field(default_factory=dict)
    inside: list[LaunchElement] = field(default_factory=list)
    taken: set[str] = field(default_factory=set)
    """The attributes that ``get`` was called for."""

    def get(self, *names: str) -> str | None:
        """Return the first of these attributes that the element has; None if it has none."""
        self.taken.update(names)
        return next((self.attributes[name] for name in names if name in self.attributes), None)

    def need(self, *names: str) -> str:
        """Return a required attribute, as `get`.

        Raises:
            LaunchFailure: the element has none of them.
        """
        found = self.get(*names)
        if found is None:
            raise LaunchFailure(f"<{self.tag}> needs the attribute {names[0]!r}")
        return found

    def all(self, *tags: str) -> list[LaunchElement]:
        """Return the elements inside with one of these tags."""
        return [each for each in self.inside if each.tag in tags]


def read_elements(file: Path, source: bytes) -> LaunchElement:
    """Return the root element of a launch file.

    Raises:
        LaunchError: the file is not well-formed, or its root is not ``launch``.
    """
    read: Callable[[bytes], LaunchElement] = _xml if file.suffix == ".xml" else _yaml
    try:
        root = read(source)
    except expat.ExpatError as error:
        raise LaunchError(f"{file.name}:{error.lineno}: {expat.errors.messages[error.code]}") from None
    except yaml.MarkedYAMLError as error:
        line = error.problem_mark.line + 1 if error.problem_mark is not None else 1
        raise LaunchError(f"{file.name}:{line}: {error.problem}") from None
    except (LaunchFailure, yaml.YAMLError, UnicodeError) as error:
        raise LaunchError(f"{file.name}: {error}") from None
    if root.tag != "launch":
        raise LaunchError(f"{file.name}:{root.line}: a launch file's root is 'launch', not {root.tag!r}")
    return root


def _xml(source: bytes) -> LaunchElement:
    parser = expat.ParserCreate()
    open_ones = [LaunchElement("", 0)]

    def start(tag: str, attributes: dict[str, str]) -> None:
        element = LaunchElement(tag, parser.CurrentLineNumber, attributes)
        open_ones[-1].inside.append(element)
        open_ones.append(element)

    parser.StartElementHandler = start
    parser.EndElementHandler = lambda _: open_ones.pop()
    parser.Parse(source, True)
    return open_ones[0].inside[0]


def _yaml(source: bytes) -> LaunchElement:
    root = yaml.compose(source, yaml.SafeLoader)
    if not isinstance(root, yaml.MappingNode) or len(root.value) != 1:
        raise LaunchFailure("a launch file in YAML is 'launch:' and a list of actions")
    tag, content = root.value[0]
    return _element(tag, content)


def _element(tag: Any, content: Any) -> LaunchElement:
    """Return an element of YAML, whose content maps names to attributes and elements, or lists elements."""
    made = LaunchElement(str(tag.value), tag.start_mark.line + 1)
    if isinstance(content, yaml.SequenceNode):
        for each in content.value:
            made.inside += _elements(each)
    elif isinstance(content, yaml.MappingNode):
        for name, value in content.value:
            _add(made, name, value)
    return made


def _elements(node: Any) -> list[LaunchElement]:
    if not isinstance(node, yaml.MappingNode):
        raise LaunchFailure(f"line {node.start_mark.line + 1}: an action is wanted, as '- node: …'")
    return [_element(tag, content) for tag, content in node.value]


def _add(made: LaunchElement, name: Any, value: Any) -> None:
    if isinstance(value, yaml.ScalarNode):
        made.attributes[name.value] = value.value
    elif name.value == "children":
        made.inside += [inside for each in value.value for inside in _elements(each)]
    elif isinstance(value, yaml.SequenceNode) and all(
        isinstance(each, yaml.ScalarNode) for each in value.value
    ):
        made.attributes[name.value] = yaml.serialize(value).strip()
    elif isinstance(value, yaml.SequenceNode):
        made.inside += [_element(name, each) for each in value.value]
    else:
        made.inside.append(_element(name, value))
