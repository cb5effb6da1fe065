"""The terminal of a run's programs: a pseudo-terminal whose keys are inputs of the run.

Waits for keys are on the run's clock.
"""

import builtins
import errno
import io
import os
import select
import selectors
import sys
import termios
import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar

from sim.clock import AutoResetEvent, RunClock, VirtualClock
from sim.engine.setup import Keyboard
from sim.engine.stdio.output import ProcessStream
from sim.engine.stdio.polling import Polling
from sim.engine.stdio.pseudo_terminal import PseudoTerminal
from sim.engine.watchdogs.wait_descriptions import WaitProblem
from sim.interpreter.function_marks import waits_for_keyboard
from sim.probes.own_code import line_of_caller, place_of_caller
from sim.quantities.nanoseconds import wait_ns
from sim.ros.middleware.process import Process, current_process
from sim.trace.events import AnyEvent, KeyboardAsked, Notice, Reading, Severity, Typed

if TYPE_CHECKING:
    from typing_extensions import Buffer  # Python has it from 3.12 on

# Kept from before a clock, or this module, replaces them.
_allocate_lock = threading.Lock
_read = os.read

_CONTROLLING = "/dev/tty"
"""The file by which a program reads from its terminal whatever its standard input is."""
FoundT = TypeVar("FoundT")
_Files: TypeAlias = Iterable[Any]
_Ready: TypeAlias = tuple[list[Any], list[Any], list[Any]]


class Terminal:
    """The near end is descriptor 0 and ``sys.stdin``; ``type`` writes to the far end. Thread-safe.

    ``scheduled`` is the number of calls of ``type`` that the run's set-up schedules.
    """

    def __init__(
        self, clock: RunClock, record: Callable[[AnyEvent], None], keyboard: Keyboard, scheduled: int
    ) -> None:
        self._clock = clock
        self._record = record
        self._pair = PseudoTerminal()
        os.dup2(self._pair.near, 0)
        self._keyboard = keyboard
        self._scheduled = scheduled
        self._is_silent = keyboard is Keyboard.NOBODY and not scheduled
        self._waiters: list[AutoResetEvent] = []
        self._asked = Reading.NOTHING
        self._warned: set[str] = set()
        self._lock = _allocate_lock()

    def put_in_place(self) -> None:
        """Connect ``sys.stdin``, ``os.read``, ``select`` and ``/dev/tty`` of this process to the terminal.

        Call it once, after a clock has replaced Python's functions.
        """
        sys.stdin = sys.__stdin__ = self._stream("r")  # type: ignore[misc]
        modules: Any = (os, select, selectors, io, builtins)
        system, selects, kinds, files, python = modules
        system.read = self._reading(os.read)
        files.open = python.open = self._opening(io.open)
        selects.select = self._selecting(select.select)
        kinds.SelectSelector._select = staticmethod(select.select)
        of_file = self._is_read_by, self._wait_with
        selects.poll = partial(Polling, *of_file, select.poll, 1e3)
        kinds.PollSelector._selector_cls = staticmethod(selects.poll)
        if hasattr(select, "epoll"):  # on Linux only
            selects.epoll = partial(Polling, *of_file, select.epoll, 1.0)
            kinds.EpollSelector._selector_cls = staticmethod(selects.epoll)

    def type(self, text: str, *, ends: bool = False, scheduled: bool = False) -> None:
        """Type text at the current moment of the run; ``ends``: it is the last."""
        with self._lock:
            self._scheduled -= scheduled
            if ends:
                self._keyboard = Keyboard.NOBODY
            if text:
                self._record(Typed(self._clock.now(), self._pair.type(text)))
            waiters = tuple(self._waiters)
        for waiter in waiters:
            waiter.set()

    def interrupts(self, text: str) -> bool:
        """Return whether text, typed now, would interrupt the program that has the terminal."""
        return self._pair.interrupts(text)

    @waits_for_keyboard
    def wait(self, deadline: int | None) -> bool:
        """Wait until there is something to read, or until the clock reaches ``deadline``.

        Without a deadline, the end of the input ends the wait, too.
        """
        _show_prompt()
        if deadline is not None and deadline <= self._clock.now():
            self._clock.sleep(0)
        waited = False
        while True:
            with self._lock:
                if self._feed():
                    break
                self._ask(without_end=deadline is None)
                over = self._is_over
                if over and deadline is None:
                    break
                waited = True
                signal = self._clock.auto_reset_event()
                self._waiters.append(signal)
            try:
                with self._awaited(not over):
                    woken = signal.wait(deadline)
            finally:
                self._waiters.remove(signal)
            if not woken:
                return False
        if waited and deadline is None:
            self._note(Reading.NOTHING)
        return True

    @waits_for_keyboard
    def read(self, size: int) -> bytes | None:
        """Read as from a terminal, and wait if its modes say so; None if there is no input and no wait."""
        while self.wait(self._deadline()):
            with self._lock:
                if self._feed():
                    return _read(self._pair.near, size)
                if self._is_over:
                    return b""
        return b"" if os.get_blocking(self._pair.near) else None

    @property
    def _is_over(self) -> bool:
        """Whether the calling thread's process gets no more input."""
        over = self._nobody_types and not self._pair.has_more
        return over or not current_process().has_keyboard

    @property
    def _nobody_types(self) -> bool:
        return self._keyboard is Keyboard.NOBODY and not self._scheduled

    def _feed(self) -> bool:
        """Send the next key or line; return whether there is something to read."""
        return current_process().has_keyboard and self._pair.feed(is_last=self._nobody_types)

    def _deadline(self) -> int | None:
        """Return until when a read waits, by the modes of the terminal; None: without a limit."""
        if not os.get_blocking(self._pair.near):
            return self._clock.now()
        if not self._pair.mode().takes_keys:
            return None
        control: list[Any] = termios.tcgetattr(self._pair.near)[6]
        if control[termios.VMIN]:
            return None
        tenths: int = control[termios.VTIME]
        return self._clock.now() + tenths * 100_000_000

    def _ask(self, *, without_end: bool) -> None:
        """Record that the calling thread's program waits, in which way, and what is wrong with that."""
        process = current_process()
        if process.has_keyboard:
            self._note(self._pair.mode())
        entity = (process.probe or process.host.probe).callback_here()
        if entity and without_end:
            problem = f"a callback waits for the keyboard ({place_of_caller()})"
            problem += ": its thread serves nothing else meanwhile"
            wait = WaitProblem(problem, "read in a thread of its own", False, line_of_caller())
            self._record_once(wait.notice(self._clock.now(), entity))
        if not process.has_keyboard:
            text = "which ros2 launch gives to no program; run this one by itself, with cbtui run or ros2 run"
            self._warn_once(f"{_name(process)} reads from the keyboard, {text}")
        elif self._is_silent:
            text = "and nobody types; run it by cbtui run or cbtui open, or have text typed: --type 2 'text'"
            self._warn_once(f"{_name(process)} reads from the keyboard, {text}")

    def _note(self, reads: Reading) -> None:
        if reads is not self._asked:
            self._asked = reads
            self._record(KeyboardAsked(self._clock.now(), reads, _name(current_process())))

    def _warn_once(self, text: str) -> None:
        self._record_once(Notice(self._clock.now(), Severity.WARN, text))

    def _record_once(self, notice: Notice) -> None:
        if notice.text not in self._warned:
            self._warned.add(notice.text)
            self._record(notice)

    @contextmanager
    def _awaited(self, live: bool) -> Iterator[None]:
        """Let a run without a speed wait for the person who types, within the block."""
        if isinstance(self._clock, VirtualClock) and live and self._keyboard is Keyboard.LIVE:
            self._clock.time.pace.awaited_inputs += 1
            try:
                yield
            finally:
                self._clock.time.pace.awaited_inputs -= 1
        else:
            yield

    # Replacements of Python's functions

    def _reading(self, read: Callable[[int, int], bytes]) -> Callable[[int, int], bytes]:
        def read_here(descriptor: int, size: int, /) -> bytes:
            if not self._is_read_by(descriptor):
                return read(descriptor, size)
            data = self.read(size)
            if data is None:
                raise BlockingIOError(errno.EAGAIN, os.strerror(errno.EAGAIN))
            return data

        return read_here

    def _selecting(self, select: Callable[..., _Ready]) -> Callable[..., _Ready]:
        def select_here(
            rlist: _Files, wlist: _Files, xlist: _Files, timeout: float | None = None, /
        ) -> _Ready:
            reads, writes, errors = list(rlist), list(wlist), list(xlist)
            ours = [each for each in reads if self._is_read_by(each)]
            if not ours or (timeout is not None and timeout < 0):
                return select(reads, writes, errors, timeout)
            others = [each for each in reads if each not in ours]

            def look() -> _Ready | None:
                ready: Any = select(others, writes, errors, 0) if others or writes or errors else ()
                return ready if any(ready) else None

            ready, typed = self._wait_with(look, timeout)
            found, writable, failed = ready or ([], [], [])
            readable = [each for each in reads if each in found or (typed and each in ours)]
            return readable, writable, failed

        return select_here

    def _wait_with(self, look: Callable[[], FoundT], timeout: float | None) -> tuple[FoundT, bool]:
        """Wait for keys unless ``look`` finds something; return its result, and whether there are keys."""
        deadline = None if timeout is None else self._clock.now() + wait_ns(timeout)
        found = look()
        typed = self.wait(self._clock.now() if found else deadline)
        return found or look(), typed

    def _opening(self, open_: Callable[..., Any]) -> Callable[..., Any]:
        def open_here(file: Any, mode: str = "r", *rest: Any, **named: Any) -> Any:
            is_terminal = file in (_CONTROLLING, Path(_CONTROLLING)) and "r" in mode and "+" not in mode
            return self._stream(mode) if is_terminal else open_(file, mode, *rest, **named)

        return open_here

    def _stream(self, mode: str) -> Any:
        buffered = io.BufferedReader(_Keys(self))
        return buffered if "b" in mode else io.TextIOWrapper(buffered, encoding="utf-8")

    def _is_read_by(self, file: Any) -> bool:
        """Return whether ``file`` is this terminal, for a calling thread on the run's clock."""
        if isinstance(self._clock, VirtualClock) and not self._clock.owns_current_thread():
            return False
        try:
            return self._pair.is_meant_by(os.fstat(file if isinstance(file, int) else file.fileno()))
        except (AttributeError, OSError, ValueError):
            return False  # Python's own function reports what is wrong


class _Keys(io.RawIOBase):
    """The raw stream of ``sys.stdin``."""

    name = "<stdin>"
    mode = "rb"

    def __init__(self, terminal: Terminal) -> None:
        self._terminal = terminal

    def readable(self) -> bool:
        return True

    def isatty(self) -> bool:
        return True

    def fileno(self) -> int:
        return 0

    def readinto(self, buffer: "Buffer") -> int | None:
        place = memoryview(buffer).cast("B")
        data = self._terminal.read(len(place))
        if data is None:
            return None
        place[: len(data)] = data
        return len(data)


def _show_prompt() -> None:
    """Record the unfinished line of the program, which is a prompt."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, ProcessStream):
            stream.show_rest()


def _name(process: Process) -> str:
    return process.label or Path(process.arguments[0]).name
