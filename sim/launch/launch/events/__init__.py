"""``launch.events``."""

from __future__ import annotations

from typing import Any

from sim.launch.launch.event import Event

__all__ = ["ExecutionComplete", "Shutdown", "TimerEvent"]


class Shutdown(Event):
    """The launch shuts down, for ``reason``."""

    name = "launch.events.Shutdown"

    def __init__(self, *, reason: str = "reason not given", due_to_sigint: bool = False) -> None:
        self.reason = reason
        self.due_to_sigint = due_to_sigint


class ExecutionComplete(Event):
    """An action is complete."""

    name = "launch.events.ExecutionComplete"

    def __init__(self, *, action: Any) -> None:
        self.action = action


class TimerEvent(Event):
    """A timer is due."""

    name = "launch.events.TimerEvent"

    def __init__(self, *, timer_action: Any) -> None:
        self.timer_action = timer_action
