"""``launch_ros.parameter_descriptions``: parameters with a type, a name or a file."""

from __future__ import annotations

from typing import Any

from sim.launch.launch.substitution import normalize_to_list_of_substitutions

__all__ = ["Parameter", "ParameterFile", "ParameterValue"]


class ParameterValue:
    """A value with a type, which is not inferred from its text."""

    def __init__(self, value: Any, *, value_type: Any = None) -> None:
        self.value = value
        self.value_type = value_type


class Parameter(ParameterValue):
    """A value with its parameter's name."""

    def __init__(self, name: Any, value: Any, *, value_type: Any = None, description: Any = None) -> None:
        super().__init__(value, value_type=value_type)
        self.name = normalize_to_list_of_substitutions(name)
        self.description = description


class ParameterFile:
    """A parameter file."""

    def __init__(self, param_file: Any, *, allow_substs: bool = False) -> None:
        if allow_substs is not False:
            raise NotImplementedError("ParameterFile(allow_substs=True) is not supported")
        self.param_file = normalize_to_list_of_substitutions(param_file)
