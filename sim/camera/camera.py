"""A camera: a process that takes one picture at a time, of the newest request."""

import multiprocessing
import sys
import threading
from collections.abc import Callable
from contextlib import redirect_stderr
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess

import msgspec

from sim.camera.process import serve
from sim.camera.wire import NoCamera, Picture, Shot
from sim.interpreter.safe_path import without_current_folder

_GRACE = 0.4
"""Seconds in which the process may end by itself before it is killed."""


class Camera:
    """Takes pictures in a process of its own, which starts with the first shot.

    ``deliver`` gets every picture; ``lost`` is called once, with a sentence, if no more can come. Both are
    called on the camera's reader thread; all methods belong to one other thread.
    """

    def __init__(
        self,
        deliver: Callable[[Picture], None],
        lost: Callable[[str], None],
        target: Callable[[Connection], None] = serve,
    ) -> None:
        self._deliver = deliver
        self._lost = lost
        self._target = target
        self._lock = threading.Lock()
        self._next: Shot | None = None
        self._busy = False
        self._stopping = False
        self.process: BaseProcess | None = None
        """The process; None before the first shot."""

    def want(self, shot: Shot) -> None:
        """Request a picture; of several requests during another picture only the newest is taken."""
        if self._stopping:
            return
        if self.process is None:
            self._start()
        with self._lock:
            if self._busy:
                self._next = shot
                return
            self._busy = True
        self._send(shot)

    def stop(self) -> None:
        """End the process, by force if necessary. Idempotent."""
        if self._stopping:
            return
        self._stopping = True
        if self.process is None:
            return
        self.process.terminate()
        self.process.join(_GRACE)
        if self.process.is_alive():
            self.process.kill()
            self.process.join()
        self._reader.join(_GRACE)
        self._pipe.close()

    def _start(self) -> None:
        context = multiprocessing.get_context("spawn")
        self._pipe, far_end = context.Pipe()
        self.process = context.Process(target=self._target, args=(far_end,), name="cbtui-camera", daemon=True)
        self._reader = threading.Thread(target=self._read, name="camera-reader", daemon=True)
        # A new process inherits standard error, and Textual's replacement of it has no descriptor.
        with redirect_stderr(sys.__stderr__), without_current_folder():
            self.process.start()
        far_end.close()
        self._reader.start()

    def _send(self, shot: Shot) -> None:
        try:
            self._pipe.send_bytes(msgspec.msgpack.encode(shot))
        except OSError:
            return  # the reader reports that the process is gone

    def _read(self) -> None:
        decoder = msgspec.msgpack.Decoder(Picture | NoCamera)
        while True:
            try:
                answer = decoder.decode(self._pipe.recv_bytes())
            except (EOFError, OSError):
                self._report_end("The camera's process has ended; show the camera again to start another.")
                return
            if isinstance(answer, NoCamera):
                self._report_end(answer.why)
                return
            self._deliver(answer)
            with self._lock:
                shot, self._next = self._next, None
                self._busy = shot is not None
            if shot is not None:
                self._send(shot)

    def _report_end(self, why: str) -> None:
        if not self._stopping:
            self._lost(why)
