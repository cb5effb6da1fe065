"""``launch.LaunchContext``: the state that a launch's entities share."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

from sim.launch.launch.event import Event
from sim.packages import Packages

if TYPE_CHECKING:
    from sim.launch.launch._processes import Processes
    from sim.launch.launch.event_handler import EventHandler
    from sim.launch.machine import Machine


@dataclass(frozen=True, slots=True)
class _Scope:
    launch_configurations: dict[str, str]
    environment: dict[str, str]
    namespace: str
    global_remaps: list[tuple[str, str]]
    global_parameters: list[list[str]]


class LaunchContext:
    """Configurations, environment and event handlers of one launch, and the queue of what is to happen.

    ``carry_out`` does what is to be done about an event. Not thread-safe: everything comes on one thread
    or under one lock, as ``Machine`` promises.
    """

    def __init__(
        self, machine: Machine, packages: Packages, launch_file: Path, carry_out: Callable[[Event], None]
    ) -> None:
        self.machine = machine
        self.carry_out = carry_out
        self.packages = packages
        self.launch_file = launch_file
        self.launch_configurations: dict[str, str] = {}
        self.environment: dict[str, str] = dict(os.environ)
        self.namespace = ""
        self.global_remaps: list[tuple[str, str]] = []
        self.global_parameters: list[list[str]] = []
        """Arguments for every node that set parameters."""
        self._scopes: list[_Scope] = []
        self.argv: tuple[str, ...] = ()
        self.locals = SimpleNamespace()
        self.event: Event | None = None
        self.is_shutdown = False
        self.timers = 0
        self.processes: Processes
        self.queue: list[Callable[[], None]] = []
        self._handlers: list[EventHandler] = []

    def open_scope(self) -> None:
        """Remember all settings, for ``close_scope`` to bring back."""
        self._scopes.append(
            _Scope(
                dict(self.launch_configurations),
                dict(self.environment),
                self.namespace,
                list(self.global_remaps),
                list(self.global_parameters),
            )
        )

    def close_scope(self) -> None:
        """Bring back the settings of when the last scope was opened."""
        scope = self._scopes.pop()
        self.launch_configurations = scope.launch_configurations
        self.environment = scope.environment
        self.namespace = scope.namespace
        self.global_remaps = scope.global_remaps
        self.global_parameters = scope.global_parameters

    def perform_substitution(self, sub: Any) -> str:
        """The text of a substitution."""
        return str(sub.perform(self))

    def say(self, text: str, severity: str = "INFO", logger: str = "launch") -> None:
        """Show a line of the launch's log."""
        self.machine.say(text, severity, logger)

    def later(self, deed: Callable[[], None]) -> None:
        """Have something done once all that is being visited has been."""
        self.queue.append(deed)

    def emit_event(self, event: Event) -> None:
        """Let an event happen, after those that are waiting."""
        self.later(lambda: self.carry_out(event))

    def register_event_handler(self, event_handler: EventHandler) -> None:
        """Have a handler asked from now on, before those that are registered."""
        self._handlers.insert(0, event_handler)

    def unregister_event_handler(self, event_handler: EventHandler) -> None:
        """Ask a handler no more."""
        self._handlers.remove(event_handler)

    @property
    def handlers(self) -> tuple[EventHandler, ...]:
        """The registered handlers, newest first."""
        return tuple(self._handlers)

    @property
    def changed_environment(self) -> dict[str, str]:
        """The variables that the launch has set to something else than they are outside of it."""
        return {name: value for name, value in self.environment.items() if os.environ.get(name) != value}
