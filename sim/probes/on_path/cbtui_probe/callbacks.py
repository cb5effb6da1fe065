"""Wrappers of callbacks that record when they start, end, raise, are suspended and resumed."""

from __future__ import annotations

import functools
import inspect
import sys
import time
import weakref
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from .own_lines import awaiting_frames, raised_at
from .recorder import now
from .unseen import leave_out_probe

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine, Generator
    from types import FrameType

    from .recorder import Here, Recorder
    from .states import WatchedEntity

_SHIFT = 1_000_000
"""The tolerance of a timer's phase in nanoseconds: reading it takes time, and clocks drift."""
_WITH_INFO = inspect.Signature(
    [inspect.Parameter(name, inspect.Parameter.POSITIONAL_ONLY) for name in ("data", "info")]
)
"""The signature by which rclpy passes the message info to a subscription's callback."""


_OTHERS = {"rclpy", "cbtui_probe", *sys.stdlib_module_names}
"""Top-level modules that are not the program's own code."""


def is_own(frame: FrameType) -> bool:
    """Whether a frame runs the program's own code, not rclpy's, the probe's or the standard library's."""
    return is_own_module(str(frame.f_globals.get("__name__", "")))


def is_own_module(name: str) -> bool:
    """Whether a module is the program's own."""
    root = name.partition(".")[0]
    return root == "__main__" or root not in _OTHERS


class Calls:
    """Records the calls of one entity's callback."""

    def __init__(self, recorder: Recorder, entity: WatchedEntity) -> None:
        self._recorder = recorder
        self._entity = entity

    def traced(self, callback: Callable[..., Any], start: Callable[..., None] | None = None) -> Any:
        """Wrap a callback so that its calls are recorded; ``start`` is called with its arguments first."""
        return self._wrapped(callback, start or self.begin, None)

    def traced_coroutine(self, coroutine: Any) -> Any:
        """Wrap a coroutine so that its steps are recorded; it is closed with what wraps it."""

        async def steps() -> Any:
            return await coroutine

        traced = self.traced(functools.wraps(coroutine)(steps))()
        weakref.finalize(traced, coroutine.close)
        return traced

    def traced_with_info(self, callback: Callable[..., Any]) -> Any:
        """Wrap the callback of a subscription so that rclpy also passes the message info.

        A callback whose signature rclpy will reject is returned unchanged.
        """
        takes = next((number for number in (1, 2) if _takes(callback, number)), None)
        if takes is None:
            return callback
        traced = self._wrapped(callback, self._begin_message, takes)
        traced.__signature__ = _WITH_INFO
        return traced

    def _wrapped(self, callback: Callable[..., Any], begin: Callable[..., None], takes: int | None) -> Any:
        """Wrap a callback so that its calls are recorded; it gets ``takes`` arguments, None: all."""
        local, enter, leave = self._recorder.local, self._enter, self._leave
        if inspect.iscoroutinefunction(callback):

            async def run_async(*args: Any, **kwargs: Any) -> Any:
                here = local.here
                steps = _Steps(self, callback(*args[:takes], **kwargs), enter(here))
                try:
                    begin(here, *args)
                except Exception as error:  # noqa: BLE001 - the program must not suffer from being watched
                    self._tell_of_own_fault(error)
                try:
                    return await steps
                except Exception as error:
                    self._fail(error)
                    raise
                finally:
                    leave(local.here, steps.outer)

            return functools.wraps(callback)(run_async)

        def run(*args: Any, **kwargs: Any) -> Any:
            here = local.here
            outer = enter(here)
            try:
                begin(here, *args)
            except Exception as error:  # noqa: BLE001 - the program must not suffer from being watched
                self._tell_of_own_fault(error)
            try:
                return callback(*args[:takes], **kwargs)
            except BaseException as error:
                self._fail(error)
                raise
            finally:
                leave(here, outer)

        return functools.wraps(callback)(run)

    def _tell_of_own_fault(self, error: Exception) -> None:
        """Report that the start of a callback could not be recorded; the callback runs nevertheless."""
        text = f"cbtui's probe could not tell of a callback's start: {error!r}"
        self._recorder.put("notice", now(), "WARN", text)

    def begin(self, here: Here, *args: Any) -> None:
        """Record the start; a client's callback has the number of the call as its first argument."""
        call = args[0] if self._entity.kind == "client" else 0
        self._recorder.put("callback_start", now(), self._entity.number, here.thread, call, 0, 0)

    def begin_service(self, here: Here, *_args: Any) -> None:
        """Record the start with the request that the calling thread has taken."""
        sent, here.sent = here.sent, 0
        self.begin_with(here, sent) if sent else self.begin(here)

    def begin_guard(self, here: Here, *_args: Any) -> None:
        """Record the start of a guard condition's callback; a later trigger counts as a new one."""
        self._entity.due = 0
        self.begin(here)

    def begin_timer(self, here: Here, *_args: Any) -> None:
        """Record the start of a timer's callback, and how late it is."""
        entity, start = self._entity, now()
        late = start - entity.due
        if 0 <= late < _SHIFT and late < entity.period:  # to ask rclpy costs more than all the rest
            entity.due += entity.period
        else:
            late = self._lateness(start)
        self._recorder.put("callback_start", start, entity.number, here.thread, 0, late, 0)

    def _lateness(self, start: int) -> int:
        """How long ago a timer was due that is called at ``start``.

        The time to its next call gives that up to whole periods: missed periods shift the next call. The
        moment at which it was due gives the rest, unless a reset has changed the timer's phase since.
        """
        entity = self._entity
        timer = entity.made()
        if timer is None:
            return 0
        left: int = timer.time_until_next_call()
        late, due = max(0, entity.period - left), entity.due
        entity.due = start + left
        missed = start - due - late
        if missed > 0 and due and (missed + _SHIFT) % max(1, entity.period) < 2 * _SHIFT:
            return start - due
        return late

    def _begin_message(self, here: Here, _message: Any, info: Any = None) -> None:
        """Record the start with a message; the C++ executor passes no message info."""
        self.begin(here) if info is None else self.begin_with(here, info["source_timestamp"])

    def begin_with(self, here: Here, sent: int) -> None:
        """Record the start with a message sent at ``sent`` (nanoseconds since 1970)."""
        age = max(0, time.time_ns() - sent)
        self._recorder.put("taken", now(), self._entity.number, here.thread, sent, age)

    def suspend(self, outer: int, coroutine: Any) -> None:
        """Record where the callback is suspended; ``outer`` runs on the calling thread again."""
        with suppress(TypeError):  # it may be none of Python's own
            self._recorder.suspended[coroutine] = self._entity.number
        frames = awaiting_frames(coroutine, is_own)
        self._leave(self._recorder.here, outer, "callback_suspend", frames)

    def resume(self, coroutine: Any) -> int:
        """Record that the callback is resumed; returns the entity that ran on the thread before."""
        with suppress(TypeError):
            self._recorder.suspended.pop(coroutine, None)
        here = self._recorder.here
        outer = self._enter(here)
        self._recorder.put("callback_resume", now(), self._entity.number, here.thread)
        return outer

    def _enter(self, here: Here) -> int:
        """Mark the callback as running; returns the entity that ran on the thread before."""
        entity = self._entity
        if entity.wait is not None:
            entity.waits_no_more(self._recorder)
        thread = here.thread or self._recorder.thread()
        outer, here.entity = here.entity, entity.number
        if outer == 0 and here.spinner is not None:
            here.spinner.busy[thread] = entity.number
        return outer

    def _leave(self, here: Here, outer: int, tag: str = "callback_end", *more: Any) -> None:
        here.entity = outer
        if outer == 0 and here.spinner is not None:
            here.spinner.busy.pop(here.thread, None)
        self._recorder.put(tag, now(), self._entity.number, here.thread, *more)

    def _fail(self, error: BaseException) -> None:
        """Record an exception of the callback, which is raised again."""
        recorder = self._recorder
        place, exception = told_of(error), type(error).__name__
        recorder.put("callback_error", now(), self._entity.number, recorder.thread(), *place, exception)
        leave_out_probe(error)


def told_of(error: BaseException) -> tuple[str, str, int]:
    """An exception's class and text, and where it was raised."""
    text = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
    return text, *raised_at(error, is_own)


class _Steps:
    """Awaits a coroutine, and records each suspension and resumption.

    ``outer`` is the entity that runs around it on the thread.
    """

    def __init__(self, calls: Calls, coroutine: Coroutine[Any, Any, Any], outer: int) -> None:
        self.outer = outer
        self._calls = calls
        self._coroutine = coroutine

    def __await__(self) -> Generator[Any, Any, Any]:
        coroutine, suspended = self._coroutine, False
        try:
            while True:
                if suspended and not _is_polled(coroutine):
                    suspended = False
                    self.outer = self._calls.resume(coroutine)
                try:
                    wanted = coroutine.send(None)
                except StopIteration as stop:
                    return stop.value
                if not suspended:
                    suspended = True
                    self._calls.suspend(self.outer, coroutine)
                yield wanted
        finally:
            coroutine.close()


def _is_polled(coroutine: Any) -> bool:
    """Whether a coroutine is only polled: the future that it awaits is not done, so it cannot go on.

    rclpy up to 7.1.6 polls awaiting tasks.
    """
    while getattr(coroutine, "cr_await", None) is not None:
        coroutine = coroutine.cr_await
    frame = getattr(coroutine, "gi_frame", None)
    future = None if frame is None else frame.f_locals.get("self")
    return future is not None and hasattr(future, "cancelled") and not (future.done() or future.cancelled())


def _takes(callback: Callable[..., Any], arguments: int) -> bool:
    """Whether a subscription's callback accepts so many arguments, by rclpy's own test."""
    try:
        inspect.signature(callback).bind(*[object()] * arguments)
    except (TypeError, ValueError):
        return False
    return True
