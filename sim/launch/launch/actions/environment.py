"""Actions on the environment of the processes that are started after them."""

# ruff: noqa: D102 -- what a method does that overrides another stands with that one

from __future__ import annotations

import os
from typing import Any

from sim.launch.errors import unsupported
from sim.launch.launch.action import Action
from sim.launch.launch.conditions import is_true
from sim.launch.launch.launch_context import LaunchContext
from sim.launch.launch.substitution import normalize_to_list_of_substitutions, performed


class SetEnvironmentVariable(Action):
    """Sets a variable."""

    def __init__(self, name: Any, value: Any, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._name = normalize_to_list_of_substitutions(name)
        self._value = normalize_to_list_of_substitutions(value)

    def execute(self, context: LaunchContext) -> None:
        context.environment[performed(context, self._name)] = performed(context, self._value)


class AppendEnvironmentVariable(Action):
    """Adds to a variable that is a list, at its end or with ``prepend`` at its beginning."""

    def __init__(
        self, name: Any, value: Any, prepend: Any = False, separator: Any = os.pathsep, **kwargs: Any
    ) -> None:
        super().__init__(**kwargs)
        self._name = normalize_to_list_of_substitutions(name)
        self._value = normalize_to_list_of_substitutions(value)
        self._prepend = prepend
        self._separator = normalize_to_list_of_substitutions(separator)

    def execute(self, context: LaunchContext) -> None:
        name, value = performed(context, self._name), performed(context, self._value)
        prepend = is_true(context, self._prepend)
        before = [context.environment[name]] if context.environment.get(name) else []
        parts = [value, *before] if prepend else [*before, value]
        context.environment[name] = performed(context, self._separator).join(parts)


# Processes that share one environment cannot lack a variable of it.
UnsetEnvironmentVariable = unsupported("UnsetEnvironmentVariable", "; set the variable to '' instead")
