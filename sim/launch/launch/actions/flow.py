"""Actions that hold other actions: groups, timers, included files, functions."""

# ruff: noqa: D102 -- what a method does that overrides another stands with that one

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from sim.launch.errors import LaunchFailure
from sim.launch.launch.action import Action, LaunchDescriptionEntity
from sim.launch.launch.actions.arguments import SetLaunchConfiguration
from sim.launch.launch.launch_context import LaunchContext
from sim.launch.launch.launch_description import LaunchDescription
from sim.launch.launch.launch_description_sources import AnyLaunchDescriptionSource, LaunchDescriptionSource
from sim.launch.launch.substitution import normalize_to_list_of_substitutions, performed


class LogInfo(Action):
    """Writes a line to the log."""

    severity = "INFO"

    def __init__(self, *, msg: Any, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.msg = normalize_to_list_of_substitutions(msg)

    def execute(self, context: LaunchContext) -> None:
        context.say(performed(context, self.msg), self.severity, "launch.user")


class OpaqueFunction(Action):
    """Calls ``function(context, *args, **kwargs)``; the actions it returns are carried out."""

    def __init__(
        self,
        *,
        function: Callable[..., Iterable[LaunchDescriptionEntity] | None],
        args: Iterable[Any] | None = None,
        kwargs: Mapping[str, Any] | None = None,
        **others: Any,
    ) -> None:
        super().__init__(**others)
        if not callable(function):
            raise TypeError(f"OpaqueFunction is given a function, not {function!r}")
        self._function = function
        self._args = tuple(args or ())
        self._kwargs = dict(kwargs or {})

    def execute(self, context: LaunchContext) -> Iterable[LaunchDescriptionEntity] | None:
        return self._function(context, *self._args, **self._kwargs)


class _Step(Action):
    """Something done between other actions."""

    def __init__(self, step: Callable[[LaunchContext], None]) -> None:
        super().__init__()
        self._step = step

    def execute(self, context: LaunchContext) -> None:
        self._step(context)


class GroupAction(Action):
    """Several actions; what they set is, unless ``scoped`` is false, forgotten after them."""

    def __init__(
        self,
        actions: Iterable[Action],
        *,
        scoped: bool = True,
        forwarding: bool = True,
        launch_configurations: Mapping[Any, Any] | None = None,
        **kwargs: Any,
    ) -> None:
        super().__init__(**kwargs)
        if not forwarding and not scoped:
            raise ValueError("a GroupAction that is not scoped cannot keep back launch configurations")
        self._actions = list(actions)
        self._scoped = scoped
        self._forwarding = forwarding
        self._settings = dict(launch_configurations or {})

    def execute(self, context: LaunchContext) -> list[LaunchDescriptionEntity]:
        settings = [SetLaunchConfiguration(name, value) for name, value in self._settings.items()]
        if not self._scoped:
            return [*settings, *self._actions]
        begin: list[LaunchDescriptionEntity] = [_Step(LaunchContext.open_scope)]
        if not self._forwarding:
            begin.append(_Step(lambda inside: inside.launch_configurations.clear()))
        return [*begin, *settings, *self._actions, _Step(LaunchContext.close_scope)]

    def parts(self) -> Iterable[LaunchDescriptionEntity]:
        return self._actions


class TimerAction(Action):
    """Carries out actions ``period`` seconds from now."""

    completes_at_once = False

    def __init__(
        self,
        *,
        period: Any,
        actions: Iterable[LaunchDescriptionEntity],
        cancel_on_shutdown: Any = True,
        **kwargs: Any,
    ) -> None:
        super().__init__(**kwargs)
        if cancel_on_shutdown is not True:
            raise NotImplementedError("TimerAction(cancel_on_shutdown=False) is not supported")
        self.period = period
        self.actions = list(actions)
        self._cancelled = False

    def cancel(self) -> None:
        """Do nothing when the time comes."""
        self._cancelled = True

    def execute(self, context: LaunchContext) -> None:
        context.processes.after(
            seconds(context, self.period, "the period of a TimerAction"), self, self._fire
        )

    def _fire(self) -> list[LaunchDescriptionEntity]:
        return [] if self._cancelled else self.actions

    def parts(self) -> Iterable[LaunchDescriptionEntity]:
        return self.actions


def seconds(context: LaunchContext, value: Any, what: str) -> float:
    """A number of seconds, given as one or as a text.

    Raises:
        LaunchFailure: it is none.
    """
    text = str(value) if isinstance(value, (int, float)) else performed(context, value)
    try:
        return max(float(text), 0.0)
    except ValueError:
        raise LaunchFailure(f"{what} is wanted in seconds, not {text!r}") from None


class IncludeLaunchDescription(Action):
    """Carries out another launch file."""

    def __init__(
        self,
        launch_description_source: Any,
        *,
        launch_arguments: Iterable[tuple[Any, Any]] | None = None,
        **kwargs: Any,
    ) -> None:
        super().__init__(**kwargs)
        if isinstance(launch_description_source, (LaunchDescriptionSource, LaunchDescription)):
            self._source = launch_description_source
        else:
            self._source = AnyLaunchDescriptionSource(launch_description_source)
        self.launch_arguments = list(
            launch_arguments.items() if isinstance(launch_arguments, Mapping) else launch_arguments or ()
        )

    def execute(self, context: LaunchContext) -> list[LaunchDescriptionEntity]:
        before = context.launch_file
        if isinstance(self._source, LaunchDescription):
            description, inside = self._source, before
        else:
            description, inside = self._source.load(context)
        given = {performed(context, name): value for name, value in self.launch_arguments}
        for declared in description.get_launch_arguments():
            is_set = declared.name in given or declared.name in context.launch_configurations
            if declared.condition is None and declared.default_value is None and not is_set:
                raise LaunchFailure(
                    f"Included launch description missing required argument '{declared.name}' "
                    f"(description: '{declared.description}'), given: [{', '.join(given)}]"
                )
        return [
            *(SetLaunchConfiguration(name, value) for name, value in given.items()),
            _Step(lambda context: _be_in(context, inside)),
            description,
            _Step(lambda context: _be_in(context, before)),
        ]

    def parts(self) -> Iterable[LaunchDescriptionEntity]:
        if isinstance(self._source, LaunchDescription):
            return [self._source]
        known = self._source.known_description()
        return [] if known is None else [known]


def _be_in(context: LaunchContext, file: Path) -> None:
    context.launch_file = file
