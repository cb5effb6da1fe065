"""``launch.conditions``."""

from __future__ import annotations

from typing import Any

from sim.launch.errors import LaunchFailure
from sim.launch.launch.condition import Condition
from sim.launch.launch.launch_context import LaunchContext
from sim.launch.launch.substitution import performed

__all__ = [
    "IfCondition",
    "InvalidConditionExpressionError",
    "LaunchConfigurationEquals",
    "LaunchConfigurationNotEquals",
    "UnlessCondition",
    "evaluate_condition_expression",
]

_TRUTHS = {"true": True, "1": True, "false": False, "0": False}


class InvalidConditionExpressionError(LaunchFailure):
    """A text that is neither true nor false."""


def evaluate_condition_expression(context: LaunchContext, expression: Any) -> bool:
    """Read a text as true or false, as ``IfCondition`` does.

    Raises:
        InvalidConditionExpressionError: the text is not ``true``, ``1``, ``false`` or ``0``.
    """
    text = performed(context, expression)
    truth = _TRUTHS.get(text.strip().lower())
    if truth is None:
        raise InvalidConditionExpressionError(
            f"invalid condition expression {text!r}: true, 1, false or 0 is wanted"
        )
    return truth


def is_true(context: LaunchContext, value: Any) -> bool:
    """Return a truth value that is given as a bool or as a text."""
    return value if isinstance(value, bool) else evaluate_condition_expression(context, value)


class IfCondition(Condition):
    """Holds if the expression reads as true."""

    def __init__(self, predicate_expression: Any) -> None:
        super().__init__(
            predicate=lambda context: evaluate_condition_expression(context, predicate_expression)
        )


class UnlessCondition(Condition):
    """Holds if the expression reads as false."""

    def __init__(self, predicate_expression: Any) -> None:
        super().__init__(
            predicate=lambda context: not evaluate_condition_expression(context, predicate_expression)
        )


class LaunchConfigurationEquals(Condition):
    """Holds if a launch configuration has the value; None: if it is not set."""

    def __init__(self, launch_configuration_name: str, expected_value: Any) -> None:
        super().__init__(
            predicate=lambda context: _has_value(context, launch_configuration_name, expected_value)
        )


class LaunchConfigurationNotEquals(Condition):
    """Holds unless a launch configuration has the value."""

    def __init__(self, launch_configuration_name: str, expected_value: Any) -> None:
        super().__init__(
            predicate=lambda context: not _has_value(context, launch_configuration_name, expected_value)
        )


def _has_value(context: LaunchContext, name: str, expected: Any) -> bool:
    wanted = None if expected is None else performed(context, expected)
    return context.launch_configurations.get(name) == wanted
