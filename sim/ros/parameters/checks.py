"""Checks of a value against a parameter's descriptor: type, range and step. Pure functions."""

import math
from typing import Any

from sim.ros.parameters.parameter import Parameter

PARAM_REL_TOL = 1e-6
"""The relative tolerance of a floating-point value at a limit or step, as in rclpy."""


def has_wrong_type(parameter: Parameter[Any], descriptor: Any) -> bool:
    """Whether a value has another type than a statically typed parameter."""
    return not descriptor.dynamic_typing and parameter.type_ not in (Parameter.Type.NOT_SET, descriptor.type)


def objection(parameter: Parameter[Any], descriptor: Any) -> str:
    """The reason why the descriptor does not allow the value; empty if it does.

    A dynamically typed descriptor gets the type of the value.
    """
    if descriptor.dynamic_typing:
        descriptor.type = parameter.type_.value
    elif has_wrong_type(parameter, descriptor):
        expected = Parameter.Type(descriptor.type)
        return f"Wrong parameter type, expected '{expected}' got '{parameter.type_}'"
    if parameter.type_ is Parameter.Type.INTEGER and descriptor.integer_range:
        return _outside_integer_range(parameter.name, parameter.value, descriptor.integer_range[0])
    if parameter.type_ is Parameter.Type.DOUBLE and descriptor.floating_point_range:
        return _outside_float_range(parameter.name, parameter.value, descriptor.floating_point_range[0])
    return ""


def _outside_integer_range(name: str, value: int, limits: Any) -> str:
    low, high = sorted((limits.from_value, limits.to_value))
    if value in (low, high):
        return ""
    if not low < value < high:
        return f"Parameter {name} out of range. Min: {low}, Max: {high}, value: {value}"
    if limits.step != 0 and (value - low) % limits.step != 0:
        return (
            f"The parameter value for {name} is not a valid step. "
            f"Min: {low}, max: {high}, value: {value}, step: {limits.step}"
        )
    return ""


def _outside_float_range(name: str, value: float, limits: Any) -> str:
    low, high = sorted((limits.from_value, limits.to_value))
    if _close(value, low) or _close(value, high):
        return ""
    if not low < value < high:
        return f"Parameter {name} out of range Min: {low}, Max: {high}, value: {value}"
    if limits.step != 0.0:
        steps = round((value - low) / limits.step)
        if not _close(low + steps * limits.step, value):
            return (
                f"The parameter value for {name} is not close enough to a valid step. "
                f"Min: {low}, max: {high}, value: {value}, step: {limits.step}"
            )
    return ""


def _close(a: float, b: float) -> bool:
    return math.isclose(a, b, rel_tol=PARAM_REL_TOL)
