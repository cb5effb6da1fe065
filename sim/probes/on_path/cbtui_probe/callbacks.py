"""Callbacks that tell when they start, fail, end, and leave and come back to their thread."""

from __future__ import annotations

import functools
import inspect
import sys
import time
from typing import TYPE_CHECKING, Any

from .recorder import now
from .unseen import leave_out_probe

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine, Generator
    from types import FrameType

    from .entities import WatchedEntity
    from .recorder import Here, Recorder

_SHIFT = 1_000_000
"""Nanoseconds by which a timer's rhythm may seem shifted: asking for it takes time, too, and clocks drift."""
_WITH_INFO = inspect.Signature(
    [inspect.Parameter(name, inspect.Parameter.POSITIONAL_ONLY) for name in ("data", "info")]
)
"""By this rclpy sees that a subscription's callback wants to know about its messages, too."""


_OTHERS = {"rclpy", "cbtui_probe", *sys.stdlib_module_names}
"""Modules that are not the program's own."""


def is_own(frame: FrameType) -> bool:
    """Whether a frame runs the program's code: not rclpy's, this package's or Python's."""
    root = str(frame.f_globals.get("__name__", "")).partition(".")[0]
    return root == "__main__" or root not in _OTHERS


def written_at(callback: Callable[..., Any] | None) -> tuple[str, str, int, int]:
    """Name, file and first and last line of a callback; empty for none."""
    if callback is None:
        return "", "", 0, 0
    while isinstance(callback, functools.partial):
        callback = callback.func
    callback = inspect.unwrap(callback)
    name = str(getattr(callback, "__name__", type(callback).__name__))
    code = getattr(callback, "__code__", None) or getattr(type(callback).__call__, "__code__", None)
    if code is None:
        return name, "", 0, 0
    lines = [line for _, _, line in code.co_lines() if line is not None]
    return name, code.co_filename, code.co_firstlineno, max(lines, default=code.co_firstlineno)


class Calls:
    """Tells of the calls of one entity's callback. ``recorder`` takes the events."""

    def __init__(self, recorder: Recorder, entity: WatchedEntity) -> None:
        self._recorder = recorder
        self._entity = entity

    def traced(self, callback: Callable[..., Any], start: Callable[..., None] | None = None) -> Any:
        """Wrap a callback so that its calls are recorded; ``start`` gets its arguments as it starts."""
        return self._wrapped(callback, start or self.begin, None)

    def traced_with_info(self, callback: Callable[..., Any]) -> Any:
        """The callback of a subscription, which has rclpy hand it what is known of a message, too.

        One that rclpy will refuse is left as it is.
        """
        takes = next((number for number in (1, 2) if _takes(callback, number)), None)
        if takes is None:
            return callback
        traced = self._wrapped(callback, self._begin_message, takes)
        traced.__signature__ = _WITH_INFO
        return traced

    def _wrapped(self, callback: Callable[..., Any], begin: Callable[..., None], takes: int | None) -> Any:
        """Wrap a callback so that its calls are recorded; it gets so many of its arguments, None: all."""
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
        """Say that the probe cannot tell that a callback starts, which runs all the same."""
        text = f"cbtui's probe could not tell of a callback's start: {error!r}"
        self._recorder.put("notice", now(), "WARN", text)

    def begin(self, here: Here, *args: Any) -> None:
        """Tell that the callback starts; a client's with the number of the call."""
        call = args[0] if self._entity.kind == "client" else 0
        self._recorder.put("callback_start", now(), self._entity.number, here.thread, call, 0, 0)

    def begin_service(self, here: Here, *_args: Any) -> None:
        """Tell that the callback starts with the request that its thread has taken."""
        sent, here.sent = here.sent, 0
        self.begin_with(here, sent) if sent else self.begin(here)

    def begin_guard(self, here: Here, *_args: Any) -> None:
        """Tell that a guard condition's callback starts; what triggers it from now on is another time."""
        self._entity.due = 0
        self.begin(here)

    def begin_timer(self, here: Here, *_args: Any) -> None:
        """Tell that a timer's callback starts, and how late."""
        entity, start = self._entity, now()
        late = start - entity.due
        if 0 <= late < _SHIFT and late < entity.period:  # to ask rclpy costs more than all the rest
            entity.due += entity.period
        else:
            late = self._lateness(start)
        self._recorder.put("callback_start", start, entity.number, here.thread, 0, late, 0)

    def _lateness(self, start: int) -> int:
        """How long ago a timer was due that is called at ``start``, by the time left to its next call.

        Periods that it missed shift its next call by as many, so that only the time tells at which it was to
        be called; not if it was reset since, which shows by its coming in another rhythm.
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
        """Tell that the callback starts with a message; an executor made of C++ hands over no information."""
        self.begin(here) if info is None else self.begin_with(here, info["source_timestamp"])

    def begin_with(self, here: Here, sent: int) -> None:
        """Tell that the callback starts with a message sent at ``sent`` (nanoseconds since 1970)."""
        age = max(0, time.time_ns() - sent)
        self._recorder.put("taken", now(), self._entity.number, here.thread, sent, age)

    def suspend(self, outer: int) -> None:
        """Tell that the callback leaves the calling thread, on which ``outer`` runs again."""
        self._leave(self._recorder.here, outer, "callback_suspend")

    def resume(self) -> int:
        """Tell that it goes on on the calling thread; returns what ran there until now."""
        here = self._recorder.here
        outer = self._enter(here)
        self._recorder.put("callback_resume", now(), self._entity.number, here.thread)
        return outer

    def _enter(self, here: Here) -> int:
        """Be what runs on the calling thread; returns what ran there until now."""
        entity = self._entity
        if entity.wait is not None:
            entity.waits_no_more(self._recorder)
        thread = here.thread or self._recorder.thread()
        outer, here.entity = here.entity, entity.number
        if outer == 0 and here.spinner is not None:
            here.spinner.busy[thread] = entity.number
        return outer

    def _leave(self, here: Here, outer: int, tag: str = "callback_end") -> None:
        here.entity = outer
        if outer == 0 and here.spinner is not None:
            here.spinner.busy.pop(here.thread, None)
        self._recorder.put(tag, now(), self._entity.number, here.thread)

    def _fail(self, error: BaseException) -> None:
        """Tell of an exception that is raised again."""
        recorder = self._recorder
        place, exception = raised_at(error), type(error).__name__
        recorder.put("callback_error", now(), self._entity.number, recorder.thread(), *place, exception)
        leave_out_probe(error)


def raised_at(error: BaseException) -> tuple[str, str, int]:
    """An exception's class and text, and file and line of the innermost frame of the program's own code."""
    place, trace = ("", 0), error.__traceback__
    while trace is not None:
        if is_own(trace.tb_frame) or not place[0]:
            place = (trace.tb_frame.f_code.co_filename, trace.tb_lineno)
        trace = trace.tb_next
    text = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
    return text, *place


class _Steps:
    """Awaits a coroutine, and tells whenever it leaves its thread and goes on.

    ``outer`` is what runs on the thread around it.
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
                    self.outer = self._calls.resume()
                try:
                    wanted = coroutine.send(None)
                except StopIteration as stop:
                    return stop.value
                if not suspended:
                    suspended = True
                    self._calls.suspend(self.outer)
                yield wanted
        finally:
            coroutine.close()


def _is_polled(coroutine: Any) -> bool:
    """Whether a coroutine waits for a future that is not done: it is asked, and will not go on.

    Jazzy up to 7.1.6 asks again and again.
    """
    while getattr(coroutine, "cr_await", None) is not None:
        coroutine = coroutine.cr_await
    frame = getattr(coroutine, "gi_frame", None)
    future = None if frame is None else frame.f_locals.get("self")
    return future is not None and hasattr(future, "cancelled") and not (future.done() or future.cancelled())


def _takes(callback: Callable[..., Any], arguments: int) -> bool:
    """Whether a subscription's callback takes so many arguments, as rclpy finds out."""
    try:
        inspect.signature(callback).bind(*[object()] * arguments)
    except TypeError:
        return False
    return True
