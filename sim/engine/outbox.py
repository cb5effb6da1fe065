"""Sends events out of the engine: a bounded queue, and a thread that sends batches down the pipe."""

import errno
import os
import signal
import socket
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from multiprocessing.connection import Connection

from sim.trace.events import AnyEvent, EventsLost, Logged, Notice, Printed, Severity, encode

# Kept from before virtual time replaces them.
_RealThread = threading.Thread
_real_sleep = time.sleep
_real_lock = threading.Lock
_monotonic = time.monotonic

_PERIOD = 0.02
"""Seconds between two batches."""
_LOOK = 0.001
"""Seconds between two checks of a thread that is held up."""
_QUIET = 5
"""Periods without a batch after which a heartbeat shows that the engine is alive."""
_BATCH = 2048
"""Events of a full batch, which is sent at once."""
_BOUND = 200_000
"""Events, and lines, that may wait on the real clock; further ones are dropped and counted."""
_LINES = 256
"""Waiting lines above which a thread that writes a line on the real clock is held up."""
_PATIENCE = 1.0
"""Seconds for which a line is held up at most, as there may be no reader."""
_TELL = 1.0
"""Seconds for which lines were held up until a notice reports it, once."""
_IN_THE_PIPE = 1 << 12
"""Bytes in the pipe's buffer on the real clock; small, as an answer waits behind all of them."""

TRACE_CLOSED = 86
"""The exit code of an engine whose program has closed the trace's pipe."""


@contextmanager
def _no_interrupt() -> Iterator[None]:
    """Hold SIGINT back from the calling thread: half a batch makes all that follows it unreadable."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


class Outbox:
    """Takes events from any thread, in order, and sends them.

    On the real clock recording does not wait, and events beyond a limit are dropped and counted. Only a
    thread that writes lines faster than they are read is held up, as by a slow terminal: so no line is lost,
    and the answer to a command is not late. On virtual time the recording thread sends a full batch itself:
    waiting for a slow reader costs no virtual time, and no event is lost.

    ``before_batch`` runs on the sending thread every period; ``pack`` encodes a batch; ``heartbeat`` returns
    the batch, perhaps empty, that is sent after some time without events.
    """

    def __init__(
        self,
        pipe: Connection,
        *,
        may_wait: bool,
        before_batch: Callable[[], None],
        pack: Callable[[list[AnyEvent]], bytes] = encode,
        heartbeat: Callable[[], list[AnyEvent]] = list,
    ) -> None:
        self._pipe = pipe
        self._exit_process = os._exit  # from before the crash dump replaces it
        self._pack = pack
        self._may_wait = may_wait
        self._before_batch = before_batch
        self._heartbeat = heartbeat
        self._waiting: deque[AnyEvent] = deque()
        self._lines: deque[AnyEvent] = deque()
        """The lines among them."""
        self._sending = _real_lock()
        self._closed = False
        self._lost = 0
        self._lost_told = 0
        self._quiet = 0
        self._held_up = 0.0
        self._bell = _real_lock()
        """Released to send before the end of the period."""
        self._bell.acquire()
        if not may_wait:
            with socket.socket(fileno=os.dup(pipe.fileno())) as end:
                end.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, _IN_THE_PIPE)

    def start(self) -> None:
        """Start the sending thread."""
        _RealThread(target=self._send_for_ever, name="outbox", daemon=True).start()

    def record(self, event: AnyEvent) -> None:
        """Take an event; ignored once closed."""
        if self._closed:
            return
        if not self._may_wait:
            is_line = isinstance(event, Logged | Printed)
            if is_line and len(self._lines) >= _LINES:
                self._hold_up(event.t)
            if len(self._lines if is_line else self._waiting) >= _BOUND:
                self._lost += 1
                return
            if is_line:
                self._lines.append(event)
        self._waiting.append(event)
        if self._may_wait and len(self._waiting) >= _BATCH:
            self.flush()

    def _hold_up(self, t: int) -> None:
        """Block the calling thread until fewer lines wait."""
        began = _monotonic()
        with suppress(RuntimeError):  # another thread has released it
            self._bell.release()
        while len(self._lines) >= _LINES and _monotonic() < began + _PATIENCE and not self._closed:
            _real_sleep(_LOOK)
        told, self._held_up = self._held_up >= _TELL, self._held_up + _monotonic() - began
        if self._held_up >= _TELL and not told:
            text = (
                "the program writes lines faster than they can be taken: what writes them is held up, "
                "as by a slow terminal; write fewer"
            )
            self._waiting.append(Notice(t, Severity.INFO, text))

    def flush(self) -> None:
        """Send all waiting events. A reader that is gone is not an error; an interrupt waits till then."""
        with _no_interrupt(), self._sending:
            waiting = len(self._waiting)
            while waiting > 0 or self._lost > self._lost_told:
                # After a pause of the reader, batches are no larger than usual.
                batch = [self._waiting.popleft() for _ in range(min(waiting, _BATCH))]
                waiting -= len(batch)
                for each in batch:
                    if self._lines and isinstance(each, Logged | Printed):
                        self._lines.popleft()
                self._send(batch)

    def _send(self, batch: list[AnyEvent]) -> None:
        if self._lost > self._lost_told:
            self._lost_told = self._lost
            batch.append(EventsLost(batch[-1].t if batch else 0, self._lost))
        try:
            self._quiet = 0
            self._pipe.send_bytes(self._pack(batch))
        except OSError as error:
            if error.errno == errno.EBADF:
                self._exit_process(TRACE_CLOSED)
            self._closed = True

    def close(self, last: AnyEvent) -> None:
        """Record ``last`` as the last event of all, and send everything."""
        if not self._closed:
            self._closed = True
            self._waiting.append(last)
        self.flush()

    def _send_for_ever(self) -> None:
        due = _monotonic()
        while True:
            self._bell.acquire(timeout=_PERIOD)
            if _monotonic() >= due:
                due = _monotonic() + _PERIOD
                self._before_batch()
            self.flush()
            self._quiet += 1
            if self._quiet >= _QUIET:
                with self._sending:
                    if not self._closed:
                        self._send(self._heartbeat())
