"""A session: one engine process, started, commanded and ended from here, and the trace it sends."""

import multiprocessing
import os
import signal
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stderr, suppress
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection
from multiprocessing.context import BaseContext
from multiprocessing.process import BaseProcess
from typing import Any, Protocol, TypeAlias
from uuid import uuid4

import msgspec

from cbtui.engines.hang_detector import LOOK, HangDetector, why_silent
from cbtui.engines.memory_limit import memory_limit
from cbtui.engines.orphan_guard import ENDS_ITSELF, watch_over
from cbtui.engines.process_tree import MARK, ProcessTree
from cbtui.engines.resource_guard import ResourceGuard
from cbtui.terminal.interrupts import whole
from sim.clean_start import without_current_folder
from sim.engine.commands import Command, Stop, encode
from sim.engine.failures.crash_dump import ASKED, overflowed, place_in, timed_out
from sim.engine.outbox import TRACE_CLOSED
from sim.engine.programs.ending import GRACE, TO_LEAVE
from sim.engine.setup import RunSetup
from sim.trace.events import AnyEvent, RunEnded, decode

Deliver: TypeAlias = Callable[[list[AnyEvent]], None]
"""Takes every batch of events, in order."""
Ended: TypeAlias = Callable[[str | None], None]
"""Told once that no more will come: None, or a sentence if the engine was lost."""


class EngineSession(Protocol):
    """One engine process. ``deliver`` and ``ended`` are called on a thread of the session's own."""

    def start(self) -> str | None:
        """Start the process; a sentence if something about it does not work."""

    def send(self, command: Command) -> None:
        """Tell the engine something; ignored once it has ended."""

    def stop(self) -> None:
        """End the process, within a second; may be called again."""


OpenSession: TypeAlias = Callable[[RunSetup, Deliver, Ended], EngineSession]
"""Makes the session of a run, and does not start it."""

AFRESH: BaseContext = multiprocessing.get_context("spawn")
"""The context that starts an engine by default."""
_GRACE = 0.4
"""Seconds that an engine without a program to end gets to end by itself before it is killed."""
LONGEST_END = GRACE + TO_LEAVE
"""Seconds that one with a program gets."""
_LONGEST_BATCH = 1 << 30
"""Bytes; the length of a batch is what the program's process says it is."""
_TO_WRITE = 0.2
"""Seconds that an engine gets to write down where its threads stand."""
_redirecting = threading.Lock()
"""Standard error is the whole process's: two engines that start together take turns at it."""


class Session:
    """One run in a process of its own.

    ``deliver`` gets every batch of events in order, ``ended`` is called once when no more will come, with
    None if the run ended as it should and with a sentence if the engine was lost. Both are called on the
    session's reader thread. A notice among the events reports an engine that sends nothing. One
    that is stopped while it runs has ``LONGEST_END`` for its program's own ending. When
    the engine has ended, whatever processes it started are ended too; one that takes more memory than
    ``resource_guard`` allows is, and so are all when this process is killed. ``context`` starts the engine's
    process, None: afresh. ``unpack`` makes events of the bytes of a batch, on the reader thread.
    """

    def __init__(
        self,
        setup: RunSetup,
        deliver: Deliver,
        ended: Ended,
        context: BaseContext | None = None,
        unpack: Callable[[bytes], list[AnyEvent]] = decode,
    ) -> None:
        self._unpack = unpack
        self._deliver = deliver
        self._ended = ended
        self._stopping = False
        self._started = False
        self._begun = False
        self._finished = False
        self._setup = setup
        self._context = context or AFRESH
        self._pipe, self._far_end = self._context.Pipe()
        self._reader = threading.Thread(target=self._read, name="trace-reader", daemon=True)

    def start(self) -> None:
        """Start the engine, its guards and the reader."""
        with whole():
            self._start()

    def _start(self) -> None:
        self._last_words = tempfile.TemporaryFile()  # noqa: SIM115 -- closed with the session
        last_words = Connection(os.dup(self._last_words.fileno()), readable=False)
        ours, self._alive = multiprocessing.Pipe(duplex=False)
        engine: Any = self._context
        self._process: BaseProcess = engine.Process(
            target=_engine,
            args=(
                self._setup.real is not None,
                msgspec.msgpack.encode(self._setup),
                self._far_end,
                last_words,
                ours,
            ),
            name="cbtui-engine",
            daemon=True,
        )
        mark = uuid4().hex
        # Starting a process hands on standard error, and Textual's stand-in for it has no descriptor.
        with _redirecting, redirect_stderr(sys.__stderr__):
            with without_current_folder():
                resource_tracker.ensure_running()  # this process's own: it must not get the engine's mark
            with engine_environment(mark):
                self._process.start()
        self._far_end.close()
        last_words.close()
        ours.close()
        assert self._process.pid is not None
        self._tree = ProcessTree(self._process.pid, mark)
        self._guard = ResourceGuard(self._tree, memory_limit(), self._ask_where_it_stands)
        self._guard.start()
        self._reader.start()
        self._started = True

    def send(self, command: Command) -> None:
        """Tell the engine something; nothing happens if it has ended."""
        try:
            self._pipe.send_bytes(encode(command))
        except OSError:
            return  # the reader tells that the engine is gone

    def stop(self) -> None:
        """End the engine, by force if it must be, what it started, and the reader. Safe to call twice.

        Nothing happens if it could not be started.
        """
        with whole():
            if self._started and not self._stopping:
                self._stopping = True
                self._stop()

    def _stop(self) -> None:
        self.send(Stop())
        runs = self._begun and not self._finished
        self._tree.wait_for_end(LONGEST_END if runs and not self._tree.is_stopped() else _GRACE)
        self._guard.stop()
        self._process.kill()
        self._process.join()
        if self._reader is not threading.current_thread():
            self._reader.join(_GRACE)
        with suppress(OSError):
            os.write(self._alive.fileno(), ENDS_ITSELF)
        self._alive.close()
        self._pipe.close()
        self._last_words.close()

    def _read(self) -> None:
        hang_detector = HangDetector()
        while True:
            try:
                if self._pipe.poll(LOOK):
                    events = hang_detector.came(self._unpack(self._pipe.recv_bytes(_LONGEST_BATCH)))
                    self._begun = True
                else:
                    events = hang_detector.nothing_came(self._why_silent)
            except (EOFError, OSError):
                break
            except msgspec.DecodeError as error:
                self._guard.stop()
                self._ended(f"the engine sent something unreadable: {error}")
                return
            self._finished = self._finished or RunEnded in map(type, events)
            if events:
                self._deliver(events)
        self._ended(None if self._finished or self._stopping else self._epitaph())

    def _why_silent(self) -> str:
        if self._tree.is_stopped():
            return "its process was stopped"
        if not self._begun:  # to one that does not listen yet, the question would be the end
            return "it has not begun yet"
        return why_silent(self._place_in_program(), self._place_in_program())

    def _place_in_program(self) -> str:
        """Where in the program the engine stands now; its report is deleted after reading."""
        self._ask_where_it_stands()
        place = self._place_written()
        self._last_words.seek(0)  # for the engine too, as the two share the position
        self._last_words.truncate()
        return place

    def _place_written(self) -> str:
        size = os.fstat(self._last_words.fileno()).st_size
        words = os.pread(self._last_words.fileno(), size, 0).decode(errors="replace")
        return place_in(words, [program.path for program in self._setup.programs])

    def _ask_where_it_stands(self) -> None:
        os.kill(self._tree.pid, ASKED)
        self._tree.wait_for_end(_TO_WRITE)

    def _epitaph(self) -> str:
        """How the engine ended, and where in the program."""
        if not self._tree.wait_for_end(_GRACE):
            self._guard.stop()
            return "the engine closed its trace"
        self._guard.wait(_GRACE)
        self._process.join(_GRACE)
        self._last_words.seek(0)
        words = self._last_words.read().decode(errors="replace")
        place = place_in(words, [program.path for program in self._setup.programs])
        return f"{self._cause(words)}{f' ({place})' if place else ''}"

    def _cause(self, last_words: str) -> str:
        code = self._process.exitcode
        if self._guard.verdict is not None:
            return f"{self._guard.verdict} and was ended"
        if code == TRACE_CLOSED:
            return "the program closed files of the engine's, as os.closerange does; close only your own"
        if code is None or code >= 0:
            held_up = "code in C held up virtual time for seconds, as only --clock real allows"
            return held_up if timed_out(last_words) else f"the engine ended with exit code {code}"
        name = signal.Signals(-code).name if -code in set(signal.Signals) else str(-code)
        if -code == signal.SIGKILL:
            return f"the engine was killed by signal {-code}"
        if overflowed(last_words):
            return f"the program called itself until its stack was full, and crashed by {name}"
        return f"the program crashed by {name}"


def _engine(
    is_real: bool, packed_setup: bytes, pipe: Connection, last_words: Connection, console: Connection
) -> None:
    """Be the engine; imported only over there, so that the console stays light."""
    watch_over(os.getpid(), console)
    ProcessTree(os.getpid(), os.environ.get(MARK, "")).leave_nothing()
    if is_real:
        from sim.real.engine import run
    else:
        from sim.engine.process import run
    run(packed_setup, pipe, last_words)


_ENVIRONMENT = {
    "PYTHONHASHSEED": "0",  # sets of strings have the same order each time
    "OPENBLAS_NUM_THREADS": "1",  # numpy starts in half the time, and nobody here multiplies matrices
}


_starting = threading.Lock()
"""Held while a process is started: until then the environment is not this process's own."""


@contextmanager
def engine_environment(mark: str = "") -> Iterator[None]:
    """Let processes started meanwhile have the engine's environment and a mark; one thread at a time.

    Ctrl-C in the terminal is the console's: they do not hear it until they have a session of their own.
    """
    wanted = {**_ENVIRONMENT, MARK: mark}
    with without_current_folder(), _starting:
        before = {name: os.environ.get(name) for name in wanted}
        os.environ.update(wanted)
        blocked = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            yield
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, blocked)
            for name, value in before.items():
                if value is None:
                    del os.environ[name]
                else:
                    os.environ[name] = value
