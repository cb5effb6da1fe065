"""Actions on launch arguments and configurations."""

# ruff: noqa: D102 -- what a method does that overrides another stands with that one

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from sim.launch.errors import LaunchFailure
from sim.launch.launch.action import Action
from sim.launch.launch.launch_context import LaunchContext
from sim.launch.launch.substitution import normalize_to_list_of_substitutions, performed


class DeclareLaunchArgument(Action):
    """An argument that can be given to the launch file as ``name:=value``."""

    def __init__(
        self,
        name: str,
        *,
        default_value: Any = None,
        description: str | None = None,
        choices: Iterable[str] | None = None,
        **kwargs: Any,
    ) -> None:
        super().__init__(**kwargs)
        self.name = name
        self.choices = None if choices is None else list(choices)
        if self.choices == []:
            raise ValueError(f"the launch argument '{name}' needs at least one choice")
        if self.choices and isinstance(default_value, str) and default_value not in self.choices:
            raise ValueError(
                f"the default {default_value!r} of the launch argument '{name}' is none of {self.choices}"
            )
        self.default_value = (
            None if default_value is None else normalize_to_list_of_substitutions(default_value)
        )
        self.description = description or "no description given"
        if self.choices:
            valid = f"Valid choices are: {self.choices}"
            self.description = f"{description}. {valid}" if description else valid

    def execute(self, context: LaunchContext) -> None:
        settings = context.launch_configurations
        if self.name not in settings:
            if self.default_value is None:
                raise LaunchFailure(
                    f"Required launch argument '{self.name}' (description: '{self.description}') "
                    "was not provided"
                )
            settings[self.name] = performed(context, self.default_value)
        if self.choices and settings[self.name] not in self.choices:
            raise LaunchFailure(
                f"Argument '{self.name}' provided value '{settings[self.name]}' is not valid. "
                f"Valid options are: {self.choices}"
            )


class SetLaunchConfiguration(Action):
    """Gives a launch configuration a value."""

    def __init__(self, name: Any, value: Any, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._name = normalize_to_list_of_substitutions(name)
        self._value = normalize_to_list_of_substitutions(value)

    def execute(self, context: LaunchContext) -> None:
        context.launch_configurations[performed(context, self._name)] = performed(context, self._value)


class UnsetLaunchConfiguration(Action):
    """Takes a launch configuration away."""

    def __init__(self, name: Any, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._name = normalize_to_list_of_substitutions(name)

    def execute(self, context: LaunchContext) -> None:
        context.launch_configurations.pop(performed(context, self._name), None)


class ResetLaunchConfigurations(Action):
    """Takes all launch configurations away and sets those given."""

    def __init__(self, launch_configurations: dict[Any, Any] | None = None, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._settings = dict(launch_configurations or {})

    def execute(self, context: LaunchContext) -> None:
        context.launch_configurations = {
            performed(context, name): performed(context, value) for name, value in self._settings.items()
        }
