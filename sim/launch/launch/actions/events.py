"""Actions that handle events and let them happen."""

# ruff: noqa: D102 -- what a method does that overrides another stands with that one

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from sim.launch.launch.action import Action, LaunchDescriptionEntity
from sim.launch.launch.event import Event
from sim.launch.launch.event_handler import EventHandler
from sim.launch.launch.events import Shutdown as ShutdownEvent
from sim.launch.launch.events.process import ProcessExited
from sim.launch.launch.launch_context import LaunchContext
from sim.launch.launch.substitution import performed


class RegisterEventHandler(Action):
    """Has an event handler asked from now on."""

    def __init__(self, event_handler: EventHandler, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        if not isinstance(event_handler, EventHandler):
            raise TypeError(f"RegisterEventHandler is given an event handler, not {event_handler!r}")
        self.event_handler = event_handler

    def execute(self, context: LaunchContext) -> None:
        context.register_event_handler(self.event_handler)


class UnregisterEventHandler(Action):
    """Has an event handler asked no more."""

    def __init__(self, event_handler: EventHandler, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.event_handler = event_handler

    def execute(self, context: LaunchContext) -> None:
        context.unregister_event_handler(self.event_handler)


class EmitEvent(Action):
    """Lets an event happen."""

    def __init__(self, *, event: Event, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        if not isinstance(event, Event):
            raise TypeError(f"EmitEvent is given an event, such as Shutdown(), not {event!r}")
        self.event = event

    def execute(self, context: LaunchContext) -> None:
        context.emit_event(self.event)


class Shutdown(Action):
    """Ends the launch and all that it started; also as the ``on_exit`` of a process."""

    def __init__(self, *, reason: Any = "reason not given", **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._reason = reason

    def execute(self, context: LaunchContext) -> Iterable[LaunchDescriptionEntity] | None:
        if isinstance(context.event, ProcessExited):
            name = context.event.process_name
            context.say(f"process[{name}] was required: shutting down launched system")
        context.emit_event(ShutdownEvent(reason=performed(context, self._reason)))
        return None
