"""``launch.substitutions``."""

from __future__ import annotations

import importlib
import os.path
import shutil
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, ClassVar

from sim.files.untrusted import MAX_PROGRAM_BYTES, read_text
from sim.launch.errors import unsupported
from sim.launch.launch.conditions import evaluate_condition_expression
from sim.launch.launch.launch_context import LaunchContext
from sim.launch.launch.substitution import (
    Substitution,
    SubstitutionFailure,
    TextSubstitution,
    normalize_to_list_of_substitutions,
    performed,
)

__all__ = [
    "AllSubstitution",
    "AndSubstitution",
    "AnySubstitution",
    "Command",
    "EnvironmentVariable",
    "EqualsSubstitution",
    "FileContent",
    "FindExecutable",
    "IfElseSubstitution",
    "LaunchConfiguration",
    "LocalSubstitution",
    "NotEqualsSubstitution",
    "NotSubstitution",
    "OrSubstitution",
    "PathJoinSubstitution",
    "PathSubstitution",
    "PythonExpression",
    "SubstitutionFailure",
    "TextSubstitution",
    "ThisLaunchFile",
    "ThisLaunchFileDir",
]


def _described(subs: Any) -> str:
    return " + ".join(each.describe() for each in normalize_to_list_of_substitutions(subs))


class LaunchConfiguration(Substitution):
    """The value of a launch argument or configuration."""

    def __init__(self, variable_name: Any, *, default: Any = None) -> None:
        self.variable_name = normalize_to_list_of_substitutions(variable_name)
        self._default = default

    def perform(self, context: LaunchContext) -> str:
        name = performed(context, self.variable_name)
        if name in context.launch_configurations:
            return context.launch_configurations[name]
        if self._default is None:
            raise SubstitutionFailure(f"launch configuration '{name}' does not exist")
        return _text_of(context, self._default)

    def describe(self) -> str:
        return f"LaunchConfig({_described(self.variable_name)})"


def _text_of(context: LaunchContext, value: Any) -> str:
    """Return a default's text; numbers and truth values are converted."""
    if isinstance(value, (bool, int, float)):
        return str(value)
    return performed(context, value)


class EnvironmentVariable(Substitution):
    """The value of an environment variable."""

    def __init__(self, name: Any, *, default_value: Any = None) -> None:
        self._name = normalize_to_list_of_substitutions(name)
        self._default = default_value

    def perform(self, context: LaunchContext) -> str:
        name = performed(context, self._name)
        if name in context.environment:
            return context.environment[name]
        if self._default is None:
            raise SubstitutionFailure(f"environment variable '{name}' does not exist")
        return performed(context, self._default)

    def describe(self) -> str:
        return f"EnvVar({_described(self._name)})"


class PathJoinSubstitution(Substitution):
    """Parts of a path, joined as ``os.path.join`` does."""

    def __init__(self, substitutions: Iterable[Any]) -> None:
        self.substitutions = [normalize_to_list_of_substitutions(each) for each in substitutions]

    def perform(self, context: LaunchContext) -> str:
        return os.path.join(*(performed(context, each) for each in self.substitutions))  # noqa: PTH118 -- a text

    def __truediv__(self, more: Any) -> PathJoinSubstitution:
        return PathJoinSubstitution([*self.substitutions, more])

    def describe(self) -> str:
        return f"PathJoin({', '.join(map(_described, self.substitutions))})"


class PathSubstitution(PathJoinSubstitution):
    """A path to which ``/`` adds parts."""

    def __init__(self, path: Any) -> None:
        super().__init__([path])


class FindExecutable(Substitution):
    """The path of a program on the PATH; ``ros2`` stays as it is."""

    def __init__(self, *, name: Any) -> None:
        self._name = normalize_to_list_of_substitutions(name)

    def perform(self, context: LaunchContext) -> str:
        name = performed(context, self._name)
        if name == "ros2":
            return name
        found = shutil.which(name, path=context.environment.get("PATH"))
        if found is None:
            raise SubstitutionFailure(f"executable '{name}' not found on the PATH")
        return found

    def describe(self) -> str:
        return f"FindExec({_described(self._name)})"


class PythonExpression(Substitution):
    """The text of a Python expression's value; the expression can use the modules of ``python_modules``."""

    def __init__(self, expression: Any, python_modules: Iterable[Any] = ("math",)) -> None:
        self.expression = normalize_to_list_of_substitutions(expression)
        modules = [python_modules] if isinstance(python_modules, str) else list(python_modules)
        self._modules = [normalize_to_list_of_substitutions(each) for each in modules]

    def perform(self, context: LaunchContext) -> str:
        expression = performed(context, self.expression)
        names: dict[str, Any] = {}
        for each in self._modules:
            module = importlib.import_module(performed(context, each))
            names[module.__name__] = module
            if module.__name__ == "math":
                names.update(vars(module))
        try:
            return str(eval(expression, {}, names))
        except Exception as error:
            raise SubstitutionFailure(
                f"the Python expression {expression!r} fails: {type(error).__name__}: {error}"
            ) from error

    def describe(self) -> str:
        return f"PythonExpr({_described(self.expression)})"


Command = unsupported("the substitution Command", ": no other programs are run here")


class FileContent(Substitution):
    """The text of a file."""

    def __init__(self, path: Any) -> None:
        self._path = normalize_to_list_of_substitutions(path)

    def perform(self, context: LaunchContext) -> str:
        path = Path(performed(context, self._path))
        try:
            return read_text(path, MAX_PROGRAM_BYTES)
        except OSError as error:
            raise SubstitutionFailure(f"{path}: {error.strerror}") from None


class ThisLaunchFile(Substitution):
    """The path of the launch file."""

    def perform(self, context: LaunchContext) -> str:
        return str(context.launch_file)


class ThisLaunchFileDir(Substitution):
    """The folder of the launch file."""

    def perform(self, context: LaunchContext) -> str:
        return str(context.launch_file.parent)


class LocalSubstitution(Substitution):
    """A dotted name of the context's ``locals``."""

    def __init__(self, expression: str, description: str | None = None) -> None:
        self.expression = expression
        self._description = description

    def perform(self, context: LaunchContext) -> str:
        value: Any = context.locals
        for name in self.expression.split("."):
            if not hasattr(value, name):
                raise SubstitutionFailure(f"the launch context has no local '{self.expression}'")
            value = getattr(value, name)
        return str(value)


class _Comparison(Substitution):
    """Compares two values as truth values or numbers if both are such, else as texts."""

    equal: ClassVar[bool]

    def __init__(self, left: Any, right: Any) -> None:
        self._sides = tuple(_as_texts(side) for side in (left, right))

    def perform(self, context: LaunchContext) -> str:
        left, right = (performed(context, side) for side in self._sides)
        return str(_same(left, right) == self.equal).lower()


def _as_texts(side: Any) -> list[Substitution]:
    if side is None:
        return []
    items = side if isinstance(side, (list, tuple)) else [side]
    return normalize_to_list_of_substitutions(
        [str(each) if isinstance(each, (bool, int, float)) else each for each in items]
    )


def _same(left: str, right: str) -> bool:
    truths = {"true", "false"}
    if left.lower() in truths and right.lower() in truths:
        return left.lower() == right.lower()
    try:
        return float(left) == float(right)
    except ValueError:
        return left == right


class EqualsSubstitution(_Comparison):
    """``true`` if both are the same."""

    equal = True


class NotEqualsSubstitution(_Comparison):
    """``true`` if they differ."""

    equal = False


class NotSubstitution(Substitution):
    """``true`` if the value is false."""

    def __init__(self, value: Any) -> None:
        self._value = _as_texts(value)

    def perform(self, context: LaunchContext) -> str:
        return str(not evaluate_condition_expression(context, self._value)).lower()


class _Junction(Substitution):
    """Combines several truth values."""

    join: ClassVar[Callable[[Iterable[object]], bool]]

    def __init__(self, *values: Any) -> None:
        self._values = [_as_texts(each) for each in values]

    def perform(self, context: LaunchContext) -> str:
        truths = [evaluate_condition_expression(context, each) for each in self._values]
        return str(type(self).join(truths)).lower()


class AllSubstitution(_Junction):
    """``true`` if all values are."""

    join = all


class AnySubstitution(_Junction):
    """``true`` if any value is."""

    join = any


class AndSubstitution(_Junction):
    """``true`` if both values are."""

    join = all

    def __init__(self, left: Any, right: Any) -> None:
        super().__init__(left, right)


class OrSubstitution(_Junction):
    """``true`` if either value is."""

    join = any

    def __init__(self, left: Any, right: Any) -> None:
        super().__init__(left, right)


class IfElseSubstitution(Substitution):
    """One of two values."""

    def __init__(self, condition: Any, if_value: Any = "", else_value: Any = "") -> None:
        self._condition = _as_texts(condition)
        self._values = {True: _as_texts(if_value), False: _as_texts(else_value)}

    def perform(self, context: LaunchContext) -> str:
        return performed(context, self._values[evaluate_condition_expression(context, self._condition)])
