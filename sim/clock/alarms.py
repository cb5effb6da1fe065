"""Signals on virtual time: alarms at virtual moments, and handlers on the main thread in its turn."""

import math
import os
import signal
import sys
from collections.abc import Iterable
from types import FrameType
from typing import Any

from sim.clock.outside_work import OutsideWork
from sim.clock.replacing import Replacements
from sim.quantities.nanoseconds import SECOND, wait_ns

_signal = signal.signal
_mask = signal.pthread_sigmask
_take = signal.sigwait
_pending = signal.sigpending
_getsignal = signal.getsignal


class ProcessSignals:
    """The signals of a run's main thread. Create it on that thread; only threads of the clock may call it."""

    def __init__(self, outside: OutsideWork) -> None:
        self._outside = outside
        self._clock = outside.clock
        self._main = self._clock.current
        self._handlers: dict[int, Any] = {}
        self._pending: list[int] = []
        self._handled = 0
        self._due_at = 0
        self._interval = 0
        self._setting = 0

    def replace(self, replacements: Replacements) -> None:
        """Replace the alarms, waits and handlers of the ``signal`` module."""
        for name in ("alarm", "setitimer", "getitimer", "pause", "signal", "getsignal", "sigpending"):
            replacements.put(signal, name, getattr(self, name))
        replacements.put(signal, "sigwait", lambda wanted: self._wait_for(wanted, None, "signal.sigwait"))
        replacements.put(
            signal, "sigwaitinfo", lambda wanted: _info(self._wait_for(wanted, None, "signal.sigwaitinfo"))
        )
        replacements.put(signal, "sigtimedwait", self.sigtimedwait)
        kill, raise_signal, pthread_kill = os.kill, signal.raise_signal, signal.pthread_kill
        replacements.put(
            os,
            "kill",
            lambda pid, number: None if pid == os.getpid() and self._deliver(number) else kill(pid, number),
        )
        replacements.put(
            signal, "raise_signal", lambda number: None if self._deliver(number) else raise_signal(number)
        )
        replacements.put(
            signal,
            "pthread_kill",
            lambda thread, number: None if number and self._deliver(number) else pthread_kill(thread, number),
        )
        self._clock.handle_signals = self._handle

    def alarm(self, seconds: int) -> int:
        """``signal.alarm``."""
        return math.ceil(self.setitimer(signal.ITIMER_REAL, int(seconds))[0])

    def setitimer(self, which: int, seconds: float, interval: float = 0.0) -> tuple[float, float]:
        """``signal.setitimer``; timers of CPU time are refused, since computing takes no virtual time."""
        before = self.getitimer(which)
        if seconds < 0 or interval < 0:
            raise signal.ItimerError(22, "Invalid argument")
        self._setting += 1
        self._interval = wait_ns(interval)
        self._due_at = 0
        if seconds:
            self._set(self._clock.now() + wait_ns(seconds))
        return before

    def getitimer(self, which: int) -> tuple[float, float]:
        """``signal.getitimer``."""
        if which != signal.ITIMER_REAL:
            raise NotImplementedError(
                "signal.ITIMER_VIRTUAL and ITIMER_PROF count computing, which takes no virtual time; "
                "use --clock real"
            )
        left = max(self._due_at - self._clock.now(), 0)
        return left / SECOND, self._interval / SECOND

    def _set(self, moment: int) -> None:
        self._due_at = moment
        setting = self._setting

        def fire() -> None:
            if setting != self._setting:
                return  # another setitimer() replaced this timer
            self._due_at = 0
            if self._interval:
                self._set(moment + self._interval)
            self._queue(signal.SIGALRM)

        self._clock.call_at(moment, fire)

    def signal(self, number: int, handler: Any) -> Any:
        """``signal.signal``; signals from outside also wait until the main thread is scheduled."""
        before = self.getsignal(number)
        _signal(number, self._on_outside_signal if callable(handler) else handler)
        self._handlers[number] = handler
        return before

    def getsignal(self, number: int) -> Any:
        """``signal.getsignal``."""
        return self._handlers.get(number, _getsignal(number))

    def pause(self) -> None:
        """``signal.pause``: wait until a handler has run."""
        before = self._handled
        while self._handled == before:
            self._clock.park(None)

    def sigtimedwait(self, wanted: Iterable[int], timeout: float) -> Any:
        """``signal.sigtimedwait``."""
        if timeout < 0:
            raise ValueError("timeout must be non-negative")
        return _info(self._wait_for(wanted, timeout, "signal.sigtimedwait"))

    def sigpending(self) -> set[Any]:
        """``signal.sigpending``."""
        return {*_pending()} | {signal.Signals(number) for number in self._pending if number in _blocked()}

    def _wait_for(self, wanted: Iterable[int], timeout: float | None, what: str) -> Any:
        numbers = set(wanted)

        def look() -> int:
            for number in self._pending:
                if number in numbers:
                    self._pending.remove(number)
                    return number
            waiting = numbers & _pending()
            return _take(waiting) if waiting else 0

        number = self._outside.wait(look, timeout, what)
        return signal.Signals(number) if number else None

    def _deliver(self, number: int) -> bool:
        """Handle a signal for this process; False if the program has no handler for it."""
        if not callable(self.getsignal(number)):
            return False
        self._queue(number)
        if self._clock.current is self._main:
            self._handle()
        return True

    def _on_outside_signal(self, number: int, _frame: FrameType | None) -> None:
        """Queue a signal that another process sent."""
        self._clock.time.inject(lambda: self._queue(number))

    def _queue(self, number: int) -> None:
        if number not in self._pending:
            self._pending.append(number)
        self._clock.unpark(self._main)

    def _handle(self) -> None:
        """Run the handlers of pending signals that are not blocked; called on the main thread."""
        if not self._pending:
            return
        blocked = _blocked()
        for number in [each for each in self._pending if each not in blocked]:
            self._pending.remove(number)
            handler = self.getsignal(number)
            if callable(handler):
                self._handled += 1
                handler(number, sys._getframe())
            elif handler is signal.SIG_DFL and number == signal.SIGALRM:
                raise SystemExit("its alarm rang and SIGALRM has no handler; signal.signal() gives it one")


def _blocked() -> set[Any]:
    blocked: set[Any] = _mask(signal.SIG_BLOCK, ())
    return blocked


def _info(number: Any) -> Any:
    """The result of ``sigwaitinfo`` for a signal from this process; None without a signal."""
    if number is None:
        return None
    return signal.struct_siginfo((number, 0, 0, os.getpid(), os.getuid(), 0, 0))
