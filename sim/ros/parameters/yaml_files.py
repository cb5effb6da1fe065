"""Parameters in YAML: single values, and files for one or more nodes.

A value gets the type of ROS's parameter parser, which differs from YAML 1.2: ``yes``, ``on``
and ``Y`` are also truth values, and numbers follow C. Source: rcl_yaml_param_parser's README and tests.
"""

import math
import re
from pathlib import Path
from typing import Any, TypeAlias

from sim.files import plain_yaml, untrusted
from sim.files.plain_yaml import YamlError

PlainValue: TypeAlias = "bool | int | float | str | list[bool] | list[int] | list[float] | list[str] | None"
"""The values of parameters in YAML; an empty list has no type and is read as None."""

NodeParameters: TypeAlias = "dict[str, dict[str, PlainValue]]"
"""Values by the node's name (or a pattern of names) and the parameter's name."""

_TRUE = frozenset(("y", "Y", "yes", "Yes", "YES", "true", "True", "TRUE", "on", "On", "ON"))
_FALSE = frozenset(("n", "N", "no", "No", "NO", "false", "False", "FALSE", "off", "Off", "OFF"))
_INTEGER = re.compile(r"[+-]?(0[xX][0-9a-fA-F]+|0[0-7]*|[1-9][0-9]*)")
_FLOAT = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?")
_SPECIAL_FLOAT = re.compile(r"[+-]?\.?(inf|nan|infinity)", re.IGNORECASE)
_MOST_DIGITS = 1000
"""The most digits of an integer: Python refuses to read decimal numbers with some thousand digits."""
_INT64 = range(-(2**63), 2**63)
_TEXT_TAG = "tag:yaml.org,2002:str"
_KEY = "ros__parameters"
_TYPE_WORDS = {bool: "bool", int: "integer", float: "double", str: "string"}


class ParameterYamlError(ValueError):
    """The text is not YAML, or not a parameter; the message names the reason and the line."""

    __module__ = "rclpy.parameter"


def read_value(text: str) -> PlainValue:
    """Read one value, such as ``5``, ``[1.0, 2.0]`` or ``on``.

    Raises:
        ParameterYamlError: it is not a value of a parameter.
    """
    root = _compose(text)
    if root is None:
        raise ParameterYamlError("there is no value")
    return _value(root)


def read_file(path: str) -> NodeParameters:
    """Read a parameter file; ParameterYamlError if the file cannot be read, or is not a parameter file."""
    try:
        text = untrusted.read_text(Path(path))
    except OSError as error:
        raise ParameterYamlError(f"Error opening YAML file: {error.strerror}") from None
    except ValueError as error:
        # A name with a zero byte cannot be the name of a file.
        reason = "it is not UTF-8" if isinstance(error, UnicodeDecodeError) else "there cannot be such a file"
        raise ParameterYamlError(f"Error opening YAML file: {reason}") from None
    return read_nodes(text)


def read_nodes(text: str) -> NodeParameters:
    """Parse the text of a parameter file; ParameterYamlError if it is not a parameter file."""
    root = _compose(text)
    found: NodeParameters = {}
    if root is not None:
        _collect_nodes(_entries(root, "a node's name"), "", found)
    return found


def _compose(text: str) -> Any:
    try:
        return plain_yaml.compose(text)
    except YamlError as error:
        raise ParameterYamlError(f"{error.problem} at line {error.line}") from None


def _collect_nodes(entries: list[tuple[str, Any]], name: str, found: NodeParameters) -> None:
    for key, node in entries:
        if key == _KEY:
            if not name:
                raise ParameterYamlError(f"{_KEY} stands at {_line(node)} without a node's name above it")
            _collect_values(_entries(node, "parameters"), "", found.setdefault(name, {}))
        elif _is_mapping(node):
            _collect_nodes(_entries(node, _KEY), f"{name}/{key}" if name else key, found)
        else:
            raise ParameterYamlError(f"Cannot have a value before {_KEY} at {_line(node)}")


def _collect_values(entries: list[tuple[str, Any]], prefix: str, found: dict[str, PlainValue]) -> None:
    for key, node in entries:
        if _is_mapping(node):
            _collect_values(_entries(node, "parameters"), f"{prefix}{key}.", found)
        else:
            found[prefix + key] = _value(node)


def _entries(node: Any, wanted: str) -> list[tuple[str, Any]]:
    if not _is_mapping(node):
        raise ParameterYamlError(f"{wanted} is wanted as 'name: …' at {_line(node)}")
    return [(str(key.value), value) for key, value in node.value]


def _is_mapping(node: Any) -> bool:
    return bool(node.id == "mapping")


def _value(node: Any) -> PlainValue:
    if node.id == "scalar":
        return _scalar(node)
    if _is_mapping(node):
        raise ParameterYamlError(f"a value or a list of values is wanted at {_line(node)}")
    values: list[Any] = []
    for item in node.value:
        if item.id != "scalar":
            raise ParameterYamlError(f"a list may hold values only, not lists or mappings, at {_line(item)}")
        value = _scalar(item)
        if values and type(value) is not type(values[0]):
            raise ParameterYamlError(
                f"Sequence should be of same type. Value type '{_TYPE_WORDS[type(value)]}' do not belong "
                f"at {_line(item)}"
            )
        values.append(value)
    return values or None


def _scalar(node: Any) -> bool | int | float | str:
    text: str = node.value
    if node.style:
        return text
    if text in _TRUE or text in _FALSE:
        return text in _TRUE
    number = _number(text)
    # Only an explicit tag makes a text of something that looks like a number.
    return text if number is None or (node.tag == _TEXT_TAG and _is_numeric(text)) else number


def _number(text: str) -> int | float | None:
    if _INTEGER.fullmatch(text):
        return _integer_or_double(text)
    if _FLOAT.fullmatch(text):
        return float(text)
    return float(text.replace(".", "")) if _SPECIAL_FLOAT.fullmatch(text) else None


def _integer_or_double(text: str) -> int | float:
    # A number that does not fit 64 bits is read as by C's strtod, which knows hexadecimal but not octal.
    if len(text) <= _MOST_DIGITS and (value := _c_integer(text)) in _INT64:
        return value
    if text.lstrip("+-")[:2] not in {"0x", "0X"}:
        return float(text)
    try:
        return float.fromhex(text)
    except OverflowError:
        return -math.inf if text.startswith("-") else math.inf


def _is_numeric(text: str) -> bool:
    return text.lstrip("+-.")[:1].isdigit()


def _c_integer(text: str) -> int:
    digits = text.lstrip("+-")
    is_octal = len(digits) > 1 and digits[0] == "0" and digits[1] in "01234567"
    value = int(digits, 8) if is_octal else int(digits, 0)
    return -value if text.startswith("-") else value


def _line(node: Any) -> str:
    return f"line {node.start_mark.line + 1}"
