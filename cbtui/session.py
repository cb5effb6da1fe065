"""A session: one engine process, started, commanded and ended from here, and the trace it sends."""

import multiprocessing
import os
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stderr
from multiprocessing.process import BaseProcess

import msgspec

from sim.engine.commands import Command, Stop, encode
from sim.engine.setup import RunSetup
from sim.trace.events import AnyEvent, RunEnded, decode

_GRACE = 0.4
"""Seconds that an engine gets to end by itself before it is killed."""


class Session:
    """One run in a process of its own.

    ``deliver`` gets every batch of events in order, ``ended`` is called once when no more will come, with
    None if the run ended as it should and with a sentence if the engine was lost. Both are called on the
    session's reader thread.
    """

    def __init__(
        self,
        setup: RunSetup,
        deliver: Callable[[list[AnyEvent]], None],
        ended: Callable[[str | None], None],
    ) -> None:
        self._deliver = deliver
        self._ended = ended
        self._stopping = False
        context = multiprocessing.get_context("spawn")
        self._pipe, self._far_end = context.Pipe()
        self._process: BaseProcess = context.Process(
            target=_engine,
            args=(msgspec.msgpack.encode(setup), self._far_end),
            name="cbtui-engine",
            daemon=True,
        )
        self._reader = threading.Thread(target=self._read, name="trace-reader", daemon=True)

    def start(self) -> None:
        """Start the engine and the reader."""
        # Starting a process hands on standard error, and Textual's stand-in for it has no descriptor.
        with _engine_environment(), redirect_stderr(sys.__stderr__):
            self._process.start()
        self._far_end.close()
        self._reader.start()

    def send(self, command: Command) -> None:
        """Tell the engine something; nothing happens if it has ended."""
        try:
            self._pipe.send_bytes(encode(command))
        except OSError:
            return  # the reader tells that the engine is gone

    def stop(self) -> None:
        """End the engine, by force if it must be, and the reader. Safe to call twice."""
        if self._stopping:
            return
        self._stopping = True
        self.send(Stop())
        self._process.join(_GRACE)
        if self._process.is_alive():
            self._process.kill()
            self._process.join()
        if self._reader is not threading.current_thread():
            self._reader.join(_GRACE)
        self._pipe.close()

    def _read(self) -> None:
        finished = False
        while True:
            try:
                events = decode(self._pipe.recv_bytes())
            except (EOFError, OSError):
                break
            except msgspec.DecodeError as error:
                self._ended(f"the engine sent something unreadable: {error}")
                return
            finished = finished or any(isinstance(event, RunEnded) for event in events)
            self._deliver(events)
        self._ended(None if finished or self._stopping else self._epitaph())

    def _epitaph(self) -> str:
        self._process.join(_GRACE)
        code = self._process.exitcode
        if code is None:
            return "the engine closed its trace"
        if code < 0:
            return f"the engine was killed by signal {-code}"
        return f"the engine ended with exit code {code}"


def _engine(packed_setup: bytes, pipe: "multiprocessing.connection.Connection") -> None:
    """Be the engine; imported only over there, so that the console stays light."""
    from sim.engine.process import run

    run(packed_setup, pipe)


_ENVIRONMENT = {
    "PYTHONHASHSEED": "0",  # sets of strings have the same order each time
    "OPENBLAS_NUM_THREADS": "1",  # numpy starts in half the time, and nobody here multiplies matrices
}


@contextmanager
def _engine_environment() -> Iterator[None]:
    """Let processes started meanwhile have the engine's environment."""
    before = {name: os.environ.get(name) for name in _ENVIRONMENT}
    os.environ.update(_ENVIRONMENT)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
