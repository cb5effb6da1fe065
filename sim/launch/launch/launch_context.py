"""``launch.LaunchContext``: the state that a launch's entities share."""

from __future__ import annotations

import os
from collections.abc import Callable
from copy import copy
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

from sim.launch.launch.event import Event
from sim.packages import Packages

if TYPE_CHECKING:
    from sim.launch.launch._processes import Processes
    from sim.launch.launch.event_handler import EventHandler
    from sim.launch.machine import Machine


_SCOPED = ("launch_configurations", "environment", "namespace", "global_remaps", "global_parameters")
"""The settings that a scope restores at its end."""


class LaunchContext:
    """Configurations, environment and event handlers of one launch, and its queue of actions.

    ``carry_out`` handles an event. Not thread-safe: all calls come on one thread or under one lock, as
    ``Machine`` guarantees.
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
        self._scopes: list[dict[str, Any]] = []
        self.argv: tuple[str, ...] = ()
        self.locals = SimpleNamespace()
        self.event: Event | None = None
        self.is_shutdown = False
        self.processes: Processes
        self.queue: list[Callable[[], None]] = []
        self._handlers: list[EventHandler] = []

    def open_scope(self) -> None:
        """Save the settings for ``close_scope``."""
        self._scopes.append({name: copy(getattr(self, name)) for name in _SCOPED})

    def close_scope(self) -> None:
        """Restore the settings that the latest open scope saved."""
        vars(self).update(self._scopes.pop())

    def perform_substitution(self, sub: Any) -> str:
        """Return the text of a substitution."""
        return str(sub.perform(self))

    def say(self, text: str, severity: str = "INFO", logger: str = "launch") -> None:
        """Show a line of the launch's log."""
        self.machine.say(text, severity, logger)

    def later(self, deed: Callable[[], None]) -> None:
        """Queue an action for after the current visit."""
        self.queue.append(deed)

    def emit_event(self, event: Event) -> None:
        """Queue an event behind the waiting ones."""
        self.later(lambda: self.carry_out(event))

    def register_event_handler(self, event_handler: EventHandler) -> None:
        """Add a handler, before those that are registered."""
        self._handlers.insert(0, event_handler)

    def unregister_event_handler(self, event_handler: EventHandler) -> None:
        """Remove a handler."""
        self._handlers.remove(event_handler)

    @property
    def handlers(self) -> tuple[EventHandler, ...]:
        """The registered handlers, newest first."""
        return tuple(self._handlers)

    @property
    def changed_environment(self) -> dict[str, str]:
        """The variables whose values in the launch differ from those of this process."""
        return {name: value for name, value in self.environment.items() if os.environ.get(name) != value}
