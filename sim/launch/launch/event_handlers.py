"""``launch.event_handlers``."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar

from sim.launch.launch.action import Action
from sim.launch.launch.event import Event
from sim.launch.launch.event_handler import EventHandler, Reaction
from sim.launch.launch.events import ExecutionComplete, Shutdown
from sim.launch.launch.events.process import ProcessExited, ProcessIO, ProcessStarted

__all__ = ["OnExecutionComplete", "OnProcessExit", "OnProcessIO", "OnProcessStart", "OnShutdown"]


class _OnActionEvent(EventHandler):
    """Matches events of one class: of every action, of one, or of those that a callable selects."""

    event_class: ClassVar[type[Event]]

    def __init__(self, target_action: Any, reaction: Reaction, *, handle_once: bool = False) -> None:
        if (
            target_action is not None
            and not isinstance(target_action, Action)
            and not callable(target_action)
        ):
            raise TypeError(
                f"{type(self).__name__} requires an action as target_action, not {target_action!r}"
            )
        self._target = target_action
        super().__init__(matcher=self._is_meant, entities=reaction, handle_once=handle_once)

    def may_match(self, kind: type[Event]) -> bool:
        return issubclass(kind, self.event_class)

    def _is_meant(self, event: Event) -> bool:
        if not isinstance(event, self.event_class):
            return False
        action: Any = getattr(event, "action", None)
        if self._target is None or action is self._target:
            return True
        return not isinstance(self._target, Action) and bool(self._target(action))


class OnProcessStart(_OnActionEvent):
    """Reacts when a process has started."""

    event_class = ProcessStarted

    def __init__(self, *, target_action: Any = None, on_start: Reaction, handle_once: bool = False) -> None:
        super().__init__(target_action, on_start, handle_once=handle_once)


class OnProcessExit(_OnActionEvent):
    """Reacts when a process has ended."""

    event_class = ProcessExited

    def __init__(self, *, target_action: Any = None, on_exit: Reaction, handle_once: bool = False) -> None:
        super().__init__(target_action, on_exit, handle_once=handle_once)


class OnProcessIO(_OnActionEvent):
    """Reacts to each line that a process prints or logs; each callable gets the event and returns a reaction.

    Loggers write to standard error, as ``[INFO] [1.5] [node]: text``.
    """

    event_class = ProcessIO

    def __init__(
        self,
        *,
        target_action: Any = None,
        on_stdin: Callable[[ProcessIO], Any] | None = None,
        on_stdout: Callable[[ProcessIO], Any] | None = None,
        on_stderr: Callable[[ProcessIO], Any] | None = None,
        handle_once: bool = False,
    ) -> None:
        def react(event: ProcessIO, _context: Any) -> Any:
            callbacks = ((event.from_stdout, on_stdout), (event.from_stderr, on_stderr), (True, on_stdin))
            callback = next(each for is_from, each in callbacks if is_from)
            return None if callback is None else callback(event)

        super().__init__(target_action, react, handle_once=handle_once)


class OnExecutionComplete(_OnActionEvent):
    """Reacts when an action is complete."""

    event_class = ExecutionComplete

    def __init__(
        self, *, target_action: Any = None, on_completion: Reaction, handle_once: bool = False
    ) -> None:
        super().__init__(target_action, on_completion, handle_once=handle_once)


class OnShutdown(EventHandler):
    """Reacts when the launch shuts down."""

    def __init__(self, *, on_shutdown: Reaction, handle_once: bool = False) -> None:
        super().__init__(
            matcher=lambda event: isinstance(event, Shutdown), entities=on_shutdown, handle_once=handle_once
        )
