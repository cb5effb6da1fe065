"""Turns the parameters of launch files into command-line arguments.

A text without a type gets the type that YAML 1.1 sees in it, as in launch_ros.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, get_args, get_origin

from sim.files import plain_yaml
from sim.files.plain_yaml import YamlError
from sim.launch.errors import LaunchFailure
from sim.launch.launch.launch_context import LaunchContext
from sim.launch.launch.substitution import Substitution, performed
from sim.launch.launch_ros.parameter_descriptions import Parameter, ParameterFile, ParameterValue

_NAME = re.compile(r"[\w.~/-]+")
_SCALARS = (bool, int, float, str)


def parameter_arguments(context: LaunchContext, parameters: Iterable[Any]) -> list[str]:
    """Return the ``-p name:=value`` and ``--params-file path`` for a node's ``parameters``.

    Raises:
        LaunchFailure: a file does not exist, or a parameter cannot have the value.
    """
    found: list[str] = []
    for each in parameters:
        if isinstance(each, Mapping):
            for name, value in _flat(context, each, ""):
                found += _set(name, value)
        elif isinstance(each, Parameter):
            found += _set(performed(context, each.name), typed_value(context, each))
        else:
            found += file_arguments(context, each)
    return found


def file_arguments(context: LaunchContext, file: Any) -> list[str]:
    """Return the ``--params-file path`` for a file, given as a path, substitutions or a ParameterFile."""
    if isinstance(file, ParameterFile):
        file = file.param_file
    path = Path(str(file) if isinstance(file, Path) else performed(context, file))
    if not path.is_file():
        raise LaunchFailure(f"the parameters file {path} does not exist")
    return ["--params-file", str(path)]


def _flat(context: LaunchContext, values: Mapping[Any, Any], prefix: str) -> Iterator[tuple[str, Any]]:
    """Yield the values of nested dictionaries by their dotted names."""
    for key, value in values.items():
        name = prefix + performed(context, key)
        if isinstance(value, Mapping):
            yield from _flat(context, value, f"{name}.")
        else:
            yield name, typed_value(context, value)


def _set(name: str, value: Any) -> list[str]:
    if not _NAME.fullmatch(name):
        raise LaunchFailure(f"the parameter name {name!r} may hold letters, digits and '_', '.', '/' only")
    return ["-p", f"{name}:={yaml_text(name, value)}"]


def typed_value(context: LaunchContext, value: Any) -> Any:
    """Return the value of a parameter of a launch file."""
    if isinstance(value, ParameterValue):
        return _with_type(context, value)
    if isinstance(value, (bool, int, float)):
        return value
    if isinstance(value, (str, Substitution)) or _is_text_in_parts(value):
        return _inferred(performed(context, value))
    if isinstance(value, Iterable):
        return [_item(context, each) for each in value]
    return value


def _is_text_in_parts(value: Any) -> bool:
    """Return whether a list is one text: launch_ros joins lists of texts with a substitution."""
    return (
        isinstance(value, Sequence)
        and not isinstance(value, (str, bytes))
        and bool(value)
        and all(isinstance(each, (str, Substitution)) for each in value)
        and any(isinstance(each, Substitution) for each in value)
    )


def _item(context: LaunchContext, item: Any) -> Any:
    """Return an item of a list; a text stays a text."""
    if isinstance(item, str):
        return item
    return typed_value(context, item)


def _with_type(context: LaunchContext, value: ParameterValue) -> Any:
    wanted, given = value.value_type, value.value
    if wanted is None:
        return typed_value(context, given)
    is_text = isinstance(given, (str, Substitution)) or _is_text_in_parts(given)
    if wanted is str and is_text:
        return performed(context, given)
    found = typed_value(context, given)
    if get_origin(wanted) in {list, Sequence}:
        (item_type,) = get_args(wanted)
        items = found if isinstance(found, list) else [found]
        return [_converted(each, item_type) for each in items]
    return _converted(found, wanted)


def _converted(value: Any, wanted: type) -> Any:
    if wanted is float and type(value) is int:
        return float(value)
    if wanted is str and isinstance(value, _SCALARS):
        return str(value)
    if type(value) is not wanted:
        raise LaunchFailure(f"the value {value!r} of a parameter is no {wanted.__name__}")
    return value


def _inferred(text: str) -> Any:
    try:
        found = plain_yaml.load(text)
    except YamlError as error:
        raise LaunchFailure(
            f"the text {text!r} of a parameter is not YAML ({error.problem}); "
            "use ParameterValue(…, value_type=str)"
        ) from None
    if found is None:
        return ""
    if isinstance(found, (*_SCALARS, list)):
        return found
    raise LaunchFailure(
        f"the text {text!r} of a parameter reads as a {type(found).__name__}; "
        "use ParameterValue(…, value_type=str)"
    )


def yaml_text(name: str, value: Any) -> str:
    """Return a value as YAML that keeps its type.

    Raises:
        LaunchFailure: a parameter cannot have the value.
    """
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int):
        return str(int(value))
    if isinstance(value, float):
        return _float_text(float(value))
    if isinstance(value, str):
        return json.dumps(str(value), ensure_ascii=False)
    if isinstance(value, list):
        kinds = {type(each) for each in value}
        if len(kinds) > 1:
            raise LaunchFailure(f"the list {value!r} of the parameter {name!r} holds values of several types")
        return f"[{', '.join(yaml_text(name, each) for each in value)}]"
    raise LaunchFailure(f"the value {value!r} of the parameter {name!r} is none that a parameter can have")


def _float_text(value: float) -> str:
    if math.isnan(value):
        return ".nan"
    if math.isinf(value):
        return ".inf" if value > 0 else "-.inf"
    return repr(value)
