"""Dates and clocks of a virtual run: ``datetime``, ``time.localtime`` and the clocks of the system.

``datetime.datetime`` itself gets a new ``now`` and ``utcnow``: modules that have imported the class see them,
subclasses inherit them, and ``isinstance`` and ``pickle`` work as before. The class's dictionary is reached
in a way that works in CPython 3.11 to 3.14.
"""

import ctypes
import datetime
import gc
import logging
import os
import resource
import time
from collections.abc import Callable
from typing import Any

from sim.clock.outside_work import OutsideWork
from sim.clock.replacing import Replacements
from sim.interpreter.function_marks import asks_time
from sim.quantities.nanoseconds import SECOND

_SINCE_1970 = ("CLOCK_REALTIME", "CLOCK_REALTIME_COARSE", "CLOCK_TAI")
_SINCE_THE_BEGINNING = ("CLOCK_MONOTONIC", "CLOCK_MONOTONIC_RAW", "CLOCK_MONOTONIC_COARSE", "CLOCK_BOOTTIME")
_OF_COMPUTING = ("CLOCK_PROCESS_CPUTIME_ID", "CLOCK_THREAD_CPUTIME_ID")


def replace_dates(replacements: Replacements, outside: OutsideWork) -> None:
    """Replace the functions for dates and clocks with virtual time; CPU time is always 0."""
    clock = replacements.clock

    def wall() -> int:
        clock.switch_point()
        return clock.epoch + clock.now()

    for name in ("localtime", "gmtime", "ctime"):
        replacements.put(time, name, _of_second(getattr(time, name), wall))
    local, ascii_time, formatted = time.localtime, time.asctime, time.strftime
    replacements.put(time, "asctime", lambda moment=None: ascii_time(moment or local()))
    replacements.put(time, "strftime", lambda text, moment=None: formatted(text, moment or local()))
    for name in ("process_time", "thread_time"):
        replacements.put(time, name, lambda: 0.0)
        replacements.put(time, f"{name}_ns", lambda: 0)
    replacements.put(os, "times", lambda: os.times_result((0.0, 0.0, 0.0, 0.0, clock.now() / SECOND)))
    usage = resource.getrusage

    def real_usage(who: int) -> resource.struct_rusage:
        outside.tell("resource.getrusage tells what this machine has spent on it")
        return usage(who)

    replacements.put(resource, "getrusage", real_usage)
    _replace_system_clocks(replacements, wall)
    _replace_now(replacements, wall)
    logs: Any = logging
    logs._startTime = time.time_ns() if isinstance(logs._startTime, int) else time.time()


def _of_second(real: Callable[[float], Any], wall: Callable[[], int]) -> Callable[..., Any]:
    def told(seconds: float | None = None) -> Any:
        return real(wall() // SECOND if seconds is None else seconds)

    return told


def _replace_system_clocks(replacements: Replacements, wall: Callable[[], int]) -> None:
    clocks: dict[int, Callable[[], int]] = {}
    for names, told in (
        (_SINCE_1970, wall),
        (_SINCE_THE_BEGINNING, lambda: wall() - replacements.clock.epoch),
        (_OF_COMPUTING, lambda: 0),
    ):
        clocks |= {getattr(time, name): told for name in names if hasattr(time, name)}
    real, real_ns = time.clock_gettime, time.clock_gettime_ns
    replacements.put(
        time, "clock_gettime", lambda number: clocks[number]() / SECOND if number in clocks else real(number)
    )
    replacements.put(
        time, "clock_gettime_ns", lambda number: clocks[number]() if number in clocks else real_ns(number)
    )


def _replace_now(replacements: Replacements, wall: Callable[[], int]) -> None:
    def at(cls: type[datetime.datetime], zone: datetime.tzinfo | None, moment: int) -> datetime.datetime:
        seconds, rest = divmod(moment, SECOND)
        return cls.fromtimestamp(seconds, zone).replace(microsecond=rest // 1000)

    @asks_time
    def now(cls: type[datetime.datetime], tz: datetime.tzinfo | None = None) -> datetime.datetime:
        return at(cls, tz, wall() if owns() else time.time_ns())

    @asks_time
    def utcnow(cls: type[datetime.datetime]) -> datetime.datetime:
        return at(cls, datetime.UTC, wall() if owns() else time.time_ns()).replace(tzinfo=None)

    owns = replacements.clock.owns_current_thread
    (slots,) = (each for each in gc.get_referents(datetime.datetime.__dict__) if isinstance(each, dict))
    slots["now"] = classmethod(now)
    slots["utcnow"] = classmethod(utcnow)
    ctypes.pythonapi.PyType_Modified(ctypes.py_object(datetime.datetime))
