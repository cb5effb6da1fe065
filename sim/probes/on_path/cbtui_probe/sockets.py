"""The socket at which a console finds this process, and the thread that looks and sends."""

from __future__ import annotations

import atexit
import json
import os
import platform
import select
import socket
import struct
import sys
import threading
import time
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import FOLLOW, PROTOCOL

if TYPE_CHECKING:
    from collections.abc import Callable

    from .recorder import Recorder

_PERIOD = 0.01
"""Seconds between two looks."""
_UNSENT = 1 << 20
"""Bytes that wait for a slow console before more is encoded; until then events wait as they are."""
_UNATTENDED = 20_000
"""Events that are kept while no console is there: the latest."""
_BATCH = 500
"""Events of one line at most."""
_VISITORS = 4
_FAREWELL = 0.5
"""Seconds for which the process's end waits for a console to take the last events."""

_encode = json.JSONEncoder(separators=(",", ":"), check_circular=False).encode


class Server:
    """Sends the events of ``recorder`` to one console at a time, and has ``look`` called in between.

    The thread is a daemon, and nothing it does can hold up or end the program.
    """

    def __init__(self, recorder: Recorder, look: Callable[[], None]) -> None:
        self._recorder = recorder
        self._look = look
        self._console: socket.socket | None = None
        self._visitors: list[socket.socket] = []
        """Those who came, and have not said yet what they want."""
        self._unsent = b""
        self._lost_told = 0
        self._ends = threading.Event()
        self._thread = threading.Thread(target=self._serve, name="cbtui-probe", daemon=True)

    def start(self, folder: str) -> None:
        """Listen in ``folder``, as ``<process id>.sock``."""
        self._path = Path(folder) / f"{os.getpid()}.sock"
        self._path.unlink(missing_ok=True)
        self._listener = socket.socket(socket.AF_UNIX)
        self._listener.bind(str(self._path))
        self._path.chmod(0o600)
        self._listener.listen(1)
        self._listener.setblocking(False)
        self._pid = os.getpid()
        atexit.register(self.close)
        self._thread.start()

    def _serve(self) -> None:
        looks = True
        while not self._ends.is_set():
            with suppress(OSError):
                select.select([self._listener], [], [], _PERIOD)
                self._meet()
            if looks:
                try:
                    self._look()
                except Exception as error:  # noqa: BLE001 - the program must not suffer from being watched
                    looks = self._goes_on_after(error)
            self._send()

    def _goes_on_after(self, error: Exception) -> bool:
        """Whether to look again: rclpy may just have been shut down, which shows as an error of any kind."""
        import rclpy

        if rclpy.ok():
            text = f"cbtui's probe cannot tell what waits in this process any more: {error!r}"
            self._recorder.put("notice", time.monotonic_ns(), "WARN", text)
            return False
        return True

    def _meet(self) -> None:
        """Take who comes, if it is the same user, and says that it wants to follow; one at a time."""
        with suppress(BlockingIOError):
            visitor, _ = self._listener.accept()
            credentials = visitor.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, 12)
            if (
                struct.unpack("3i", credentials)[1] not in (0, os.getuid())
                or len(self._visitors) >= _VISITORS
            ):
                visitor.close()
                return
            visitor.setblocking(False)
            visitor.sendall(_lines([self._hello()]))
            self._visitors.append(visitor)
        for visitor in list(self._visitors):
            try:
                said = visitor.recv(len(FOLLOW))
            except BlockingIOError:
                continue
            self._visitors.remove(visitor)
            if said == FOLLOW and self._console is None:
                self._follow(visitor)
            else:
                visitor.close()

    def _follow(self, console: socket.socket) -> None:
        """Tell a console what is there, what happened lately, and from now on all that happens."""
        self._console = console
        waiting = self._recorder.take()
        told = set(waiting)
        known = [event for event in self._recorder.appeared.values() if event not in told]
        self._unsent = _lines([*known, *waiting])

    def _hello(self) -> tuple[Any, ...]:
        return (
            "hello",
            time.monotonic_ns(),
            PROTOCOL,
            os.getpid(),
            platform.python_version(),
            os.environ.get("ROS_DISTRO", ""),
            [sys.executable, *sys.argv],
            time.time_ns(),
        )

    def _send(self) -> None:
        console = self._console
        if console is None:
            self._recorder.trim(_UNATTENDED)
            return
        if len(self._unsent) < _UNSENT:
            events = self._recorder.take()
            if self._recorder.lost > self._lost_told:
                self._lost_told = self._recorder.lost
                events.append(("lost", time.monotonic_ns(), self._lost_told))
            self._unsent += _lines(events)
        try:
            while self._unsent:
                self._unsent = self._unsent[console.send(self._unsent) :]
        except BlockingIOError:
            return
        except OSError:  # it has gone, and the program goes on
            console.close()
            self._console, self._unsent = None, b""

    def close(self) -> None:
        """Hand on what is left, and listen no more; a child made by fork has nothing to hand on."""
        if os.getpid() != self._pid:
            return
        self._ends.set()
        self._thread.join(_FAREWELL)
        ends_at = time.monotonic() + _FAREWELL
        while self._console is not None and time.monotonic() < ends_at:
            self._send()
            if not self._unsent:
                break
            time.sleep(_PERIOD)
        for each in (self._listener, *self._visitors, self._console):
            if each is not None:
                each.close()
        self._path.unlink(missing_ok=True)


def _lines(events: list[tuple[Any, ...]]) -> bytes:
    """Lines of JSON, each an array of events: one event at a time takes three times as long."""
    batches = (events[start : start + _BATCH] for start in range(0, len(events), _BATCH))
    return b"".join(_encode(batch).encode() + b"\n" for batch in batches)
