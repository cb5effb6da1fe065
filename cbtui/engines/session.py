"""One engine process: started, commanded and ended from here, and the trace that it sends."""

import multiprocessing
import os
import signal
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stderr, suppress
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection
from multiprocessing.context import BaseContext
from multiprocessing.process import BaseProcess
from types import ModuleType
from typing import Any, Protocol, TypeAlias
from uuid import uuid4

import msgspec

from cbtui.engines.hang_detector import POLL_INTERVAL, HangDetector, why_silent
from cbtui.engines.memory_limit import memory_limit
from cbtui.engines.orphan_guard import ENDED_NORMALLY, start_orphan_guard
from cbtui.engines.process_tree import MARK, ProcessTree
from cbtui.engines.resource_guard import ResourceGuard
from cbtui.terminal.interrupts import deferred_interrupt
from sim.engine.commands import Command, Stop, encode
from sim.engine.failures.crash_dump import ASKED, left_process, overflowed, place_in, timed_out
from sim.engine.outbox import TRACE_CLOSED
from sim.engine.programs.ending import GRACE, TO_LEAVE
from sim.engine.setup import RunSetup
from sim.interpreter.safe_path import without_current_folder
from sim.trace.events import AnyEvent, RunEnded, decode

Deliver: TypeAlias = Callable[[list[AnyEvent]], None]
"""Takes every batch of events, in order."""
Ended: TypeAlias = Callable[[str | None], None]
"""Called once after the last batch: with None, or with a sentence if the engine was lost."""


class EngineSession(Protocol):
    """One engine process. ``deliver`` and ``ended`` are called on a thread of the session's own."""

    def start(self) -> str | None:
        """Start the process; returns a sentence if part of it does not work."""

    def send(self, command: Command) -> None:
        """Send a command to the engine; ignored once it has ended."""

    def stop(self) -> None:
        """End the process within a second. Idempotent."""


OpenSession: TypeAlias = Callable[[RunSetup, Deliver, Ended], EngineSession]
"""Creates the session of a run without starting it."""

SPAWN_CONTEXT: BaseContext = multiprocessing.get_context("spawn")
"""The context that starts an engine by default."""
_EXIT_TIMEOUT = 0.4
"""Seconds that an engine without a running program has to exit before it is killed."""
PROGRAM_EXIT_TIMEOUT = GRACE + TO_LEAVE
"""Seconds that an engine with a running program has to exit before it is killed."""
_LONGEST_BATCH = 1 << 30
"""Bytes; the length comes from the program's process and cannot be trusted."""
_REPORT_TIMEOUT = 0.2
"""Seconds that an engine has to write a dump of its threads' stacks."""
_LATE_REPORT_TIMEOUT = 1.0
"""Seconds after which a dump that a busy machine delays is given up."""
_stderr_lock = threading.Lock()
"""Guards ``sys.stderr``, which is redirected while an engine starts."""


class ProcessSession:
    """A session with an engine in a process of its own.

    ``deliver`` gets every batch of events in order. ``ended`` is called once after the last one, with None
    after a normal end and with a sentence if the engine was lost. Both are called on the session's reader
    thread. A notice among the events reports a silent engine. An engine that is stopped while its program
    runs has ``PROGRAM_EXIT_TIMEOUT`` seconds to exit. The engine's whole process tree is ended with it, when
    it exceeds a limit of ``resource_guard``, and when this process is killed. ``context`` starts the
    process; None stands for ``SPAWN_CONTEXT``. ``unpack`` decodes a batch, on the reader thread.
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
        self._context = context or SPAWN_CONTEXT
        self._pipe, self._far_end = self._context.Pipe()
        self._reader = threading.Thread(target=self._read, name="trace-reader", daemon=True)

    def start(self) -> None:
        """Start the engine, its guards and the reader."""
        with deferred_interrupt():
            self._start()

    def _start(self) -> None:
        self._stack_dump = tempfile.TemporaryFile()  # noqa: SIM115 -- closed with the session
        stack_dump = Connection(os.dup(self._stack_dump.fileno()), readable=False)
        ours, self._alive = multiprocessing.Pipe(duplex=False)
        engine: Any = self._context
        mark = uuid4().hex
        self._process: BaseProcess = engine.Process(
            target=_engine,
            args=(
                self._setup.real is not None,
                msgspec.msgpack.encode(self._setup),
                self._far_end,
                stack_dump,
                ours,
                mark,
            ),
            name="cbtui-engine",
            daemon=True,
        )
        # A child inherits standard error, and Textual's replacement of it has no descriptor.
        with _stderr_lock, redirect_stderr(sys.__stderr__):
            with without_current_folder():
                resource_tracker.ensure_running()  # for all engines, so it must not carry a mark
            with engine_environment(mark):
                self._process.start()
        self._far_end.close()
        stack_dump.close()
        ours.close()
        assert self._process.pid is not None
        self._tree = ProcessTree(self._process.pid, mark)
        self._guard = ResourceGuard(self._tree, memory_limit(), self._request_stack_dump)
        self._guard.start()
        self._reader.start()
        self._started = True

    def send(self, command: Command) -> None:
        """Send a command to the engine; ignored once it has ended."""
        try:
            self._pipe.send_bytes(encode(command))
        except OSError:
            return  # the reader reports that the engine is gone

    def stop(self) -> None:
        """End the engine's process tree, by force if need be, and the reader. Idempotent.

        Does nothing if the engine was not started.
        """
        with deferred_interrupt():
            if self._started and not self._stopping:
                self._stopping = True
                self._stop()

    def _stop(self) -> None:
        self.send(Stop())
        may_end_itself = self._begun and not self._tree.is_stopped()
        self._tree.wait_for_end(PROGRAM_EXIT_TIMEOUT if may_end_itself else _EXIT_TIMEOUT)
        self._guard.stop()
        self._process.kill()
        self._process.join()
        if self._reader is not threading.current_thread():
            self._reader.join(_EXIT_TIMEOUT)
        with suppress(OSError):
            os.write(self._alive.fileno(), ENDED_NORMALLY)
        self._alive.close()
        self._pipe.close()
        self._stack_dump.close()

    def _read(self) -> None:
        hang_detector = HangDetector()
        while True:
            try:
                if self._pipe.poll(POLL_INTERVAL):
                    events = hang_detector.received(self._unpack(self._pipe.recv_bytes(_LONGEST_BATCH)))
                    self._begun = True
                else:
                    events = hang_detector.polled_nothing(self._why_silent)
            except (EOFError, OSError):
                break
            except msgspec.DecodeError as error:
                self._guard.stop()
                self._ended(f"the engine sent something unreadable: {error}")
                return
            self._finished = self._finished or RunEnded in map(type, events)
            if events:
                self._deliver(events)
        self._ended(None if self._finished or self._stopping else self._loss())

    def _why_silent(self) -> str:
        if self._tree.is_stopped():
            return "its process was stopped"
        if not self._begun:  # the signal would kill an engine that has no handler yet
            return "it has not begun yet"
        return why_silent(self._place_in_program(), self._place_in_program())

    def _place_in_program(self) -> str:
        """The line of the program that runs now; the dump is deleted after reading."""
        self._request_stack_dump()
        place = self._place_in_dump()
        self._stack_dump.seek(0)  # the engine shares the file position
        self._stack_dump.truncate()
        return place

    def _place_in_dump(self) -> str:
        size = os.fstat(self._stack_dump.fileno()).st_size
        words = os.pread(self._stack_dump.fileno(), size, 0).decode(errors="replace")
        return place_in(words, [program.path for program in self._setup.programs])

    def _request_stack_dump(self) -> None:
        os.kill(self._tree.pid, ASKED)
        given_up_at = time.monotonic() + _LATE_REPORT_TIMEOUT
        while not (self._tree.wait_for_end(_REPORT_TIMEOUT) or os.fstat(self._stack_dump.fileno()).st_size):
            if time.monotonic() > given_up_at:
                break

    def _loss(self) -> str:
        """Why the engine was lost, and at which line of the program."""
        if not self._tree.wait_for_end(_EXIT_TIMEOUT):
            self._guard.stop()
            return "the engine closed its trace"
        self._guard.wait(_EXIT_TIMEOUT)
        self._process.join(_EXIT_TIMEOUT)
        self._stack_dump.seek(0)
        words = self._stack_dump.read().decode(errors="replace")
        place = place_in(words, [program.path for program in self._setup.programs])
        return f"{self._cause(words)}{f' ({place})' if place else ''}"

    def _cause(self, stack_dump: str) -> str:
        code = self._process.exitcode
        if self._guard.verdict is not None:
            return f"{self._guard.verdict} and was ended"
        if code == TRACE_CLOSED:
            return "the program closed files of the engine's, as os.closerange does; close only your own"
        if code is None or code >= 0:
            return _exited(code, stack_dump)
        name = signal.Signals(-code).name if -code in set(signal.Signals) else str(-code)
        if -code == signal.SIGKILL:
            return f"the engine was killed by signal {-code}"
        if overflowed(stack_dump):
            return f"the program called itself until its stack was full, and crashed with {name}"
        return f"the program crashed with {name}"


def _exited(code: int | None, stack_dump: str) -> str:
    """Why an engine exited that should not, by its exit code."""
    if timed_out(stack_dump):
        return "code in C held up virtual time for seconds, as only --clock real allows"
    if left_process(stack_dump):
        return f"the program ended its process by os._exit(), with exit code {code}"
    return f"the engine ended with exit code {code}"


def _engine(
    is_real: bool,
    packed_setup: bytes,
    pipe: Connection,
    stack_dump: Connection,
    console: Connection,
    mark: str,
) -> None:
    """Run the engine; its modules are imported only in this process, to keep the console light."""
    os.environ[MARK] = mark  # a copy of a prepared process has the environment of that one
    tree = ProcessTree(os.getpid(), mark)
    start_orphan_guard(tree, console)
    tree.end_tree_on_exit()
    if is_real:
        from sim.real.engine import run
    else:
        from sim.engine.process import run
    run(packed_setup, pipe, stack_dump)


_ENVIRONMENT = {
    "PYTHONHASHSEED": "0",  # sets of strings iterate in the same order in every run
    "OPENBLAS_NUM_THREADS": "1",  # numpy starts in half the time
}


_environment_lock = threading.Lock()
"""Held while a child process starts with a changed ``os.environ``."""


@contextmanager
def engine_environment(mark: str = "") -> Iterator[None]:
    """Start processes inside the block with the engine's environment and a mark; one thread at a time.

    SIGINT is blocked in them, so that Ctrl-C in the terminal reaches the console alone. The main module of
    this process, which an engine does not need, is hidden, as multiprocessing would import it in them.
    """
    wanted = {**_ENVIRONMENT, MARK: mark}
    with without_current_folder(), _environment_lock:
        before = {name: os.environ.get(name) for name in wanted}
        os.environ.update(wanted)
        main, sys.modules["__main__"] = sys.modules["__main__"], ModuleType("__main__")
        blocked = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            yield
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, blocked)
            sys.modules["__main__"] = main
            for name, value in before.items():
                if value is None:
                    del os.environ[name]
                else:
                    os.environ[name] = value
