"""The server thread of the probe: samples, and sends events to the consoles that connect."""

from __future__ import annotations

import atexit
import hmac
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

from . import FOLLOW, PORT, PORTS, PROTOCOL, TOKEN
from .consoles import Console, lines
from .latest import Latest

if TYPE_CHECKING:
    from collections.abc import Callable

    from .recorder import Recorder
    from .turns import Turns

_PERIOD = 0.01
"""The shortest time between two samples, in seconds."""
_LONGEST_PERIOD = 0.1
_WAITING_SHARE = 0.1
"""The largest share of the time that the thread may wait for the GIL: a waiting thread slows each call into
rclpy that releases it."""
_LOOKING_SHARE = 0.02
"""The largest share of one core for sampling, as far as the longest period allows."""
_CONSOLES = 4
"""The most consoles that are connected, and the most connections that have not yet sent a request."""
_LONGEST_WORD = 200
"""The most bytes of a request."""
_FAREWELL = 0.5
"""The longest time for which the end of the process waits until the last events are sent, in seconds."""


class _Visitor:
    """A connection that has not sent its request yet; with a ``token`` it must send that first."""

    def __init__(self, connection: socket.socket, token: str) -> None:
        self.connection = connection
        self.is_greeted = False
        self._token = token
        self._said = b""

    @property
    def is_trusted(self) -> bool:
        """Whether it may get the description of the process."""
        return not self._token

    def listen(self) -> bytes | None:
        """The request, once it has arrived; empty if the connection is to be refused, None: not yet."""
        with suppress(BlockingIOError):
            said = self.connection.recv(_LONGEST_WORD)
            self._said += said
            if not said or len(self._said) > _LONGEST_WORD:
                return b""
        word, end, rest = self._said.partition(b"\n")
        if end and self._token:
            if not hmac.compare_digest(word, self._token.encode()):
                return b""
            self._token, self._said = "", rest
            word, end, _ = rest.partition(b"\n")
        return word + end if end else None


class Server:
    """Sends the events of ``recorder`` to consoles, and calls ``look`` to sample in between.

    Its thread is a daemon; nothing that it does blocks or ends the program.
    """

    def __init__(self, recorder: Recorder, look: Callable[[], None], turns: Turns) -> None:
        self._recorder = recorder
        self._look = look
        self._turns = turns
        self._token = os.environ.get(TOKEN, "")
        self._listeners: list[socket.socket] = []
        self._visitors: list[_Visitor] = []
        self._consoles: list[Console] = []
        self._latest = Latest()
        self._ends = threading.Event()
        self._thread = threading.Thread(target=self._serve, name="cbtui-probe", daemon=True)

    def start(self, folder: str) -> None:
        """Listen at ``<process id>.sock`` in ``folder``, and on the port that the environment names."""
        self._path = Path(folder) / f"{os.getpid()}.sock"
        deaf = self._path.with_suffix(".new")  # a socket that refuses is taken for a dead process's
        deaf.unlink(missing_ok=True)
        listener = socket.socket(socket.AF_UNIX)
        listener.bind(str(deaf))
        deaf.chmod(0o600)
        self._listeners.append(listener)
        if os.environ.get(PORT) and self._token:
            self._listen_on_loopback(int(os.environ[PORT]))
        for each in self._listeners:
            each.listen(_CONSOLES)
            each.setblocking(False)
        deaf.rename(self._path)
        self._pid = os.getpid()
        atexit.register(self.close)
        self._thread.start()

    def _listen_on_loopback(self, first: int) -> None:
        """Listen on the first free port: other processes of the same command use the others."""
        for port in range(first, first + PORTS):
            listener = socket.socket()
            try:
                listener.bind(("127.0.0.1", port))
            except OSError:
                listener.close()
                continue
            self._listeners.append(listener)
            sys.stderr.write(f"cbtui's probe listens on 127.0.0.1:{port}\n")
            return
        sys.stderr.write(f"cbtui's probe found no free port from {first} to {first + PORTS - 1}\n")

    def _serve(self) -> None:
        looks, looked, period = True, 0.0, _PERIOD
        while not self._ends.is_set():
            began = time.monotonic()
            self._turns.end(period)
            with suppress(OSError):
                for listener in select.select(self._listeners, [], [], period)[0]:
                    self._let_in(listener)
            waited = time.monotonic() - began - period
            period = max(_PERIOD, waited / _WAITING_SHARE, looked / _LOOKING_SHARE)
            period = min(period, _LONGEST_PERIOD)
            self._meet()
            if looks:
                began = time.thread_time()
                try:
                    self._look()
                except Exception as error:  # noqa: BLE001 - the program must not suffer from being watched
                    looks = self._goes_on_after(error)
                looked = time.thread_time() - began
            self._send()

    def _goes_on_after(self, error: Exception) -> bool:
        """Whether to go on sampling: after rclpy's shutdown an error of any kind is expected."""
        import rclpy

        if rclpy.ok():
            text = f"cbtui's probe cannot tell what waits in this process any more: {error!r}"
            self._recorder.put("notice", time.monotonic_ns(), "WARN", text)
            return False
        return True

    def _let_in(self, listener: socket.socket) -> None:
        """Accept a connection of the same user; on a port, of whoever sends the token."""
        connection, _ = listener.accept()
        is_local = listener.family == socket.AF_UNIX
        if len(self._visitors) >= _CONSOLES or (is_local and _user_of(connection) not in (0, os.getuid())):
            connection.close()
            return
        connection.setblocking(False)
        self._visitors.append(_Visitor(connection, "" if is_local else self._token))

    def _meet(self) -> None:
        for visitor in list(self._visitors):
            try:
                wish = visitor.listen()
                if visitor.is_trusted and not visitor.is_greeted:
                    visitor.is_greeted = True
                    visitor.connection.sendall(lines([self._hello()]))
            except OSError:  # it has gone
                wish = b""
            if wish is None:
                continue
            self._visitors.remove(visitor)
            if wish == FOLLOW and len(self._consoles) < _CONSOLES:
                self._follow(visitor.connection)
            else:
                visitor.connection.close()

    def _follow(self, connection: socket.socket) -> None:
        """Send a console the state, the latest events, and from now on all events."""
        console = Console(connection)
        console.tell(*self._latest.whole())
        self._consoles.append(console)

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
        events = self._recorder.take()
        told = lines(events)
        if events:
            self._latest.add(events, told)
        for console in list(self._consoles):
            console.tell(told, len(events))
            console.tell_lost(self._recorder.lost)
            if not console.send():
                self._consoles.remove(console)

    def close(self) -> None:
        """Send the last events and stop listening; a forked child sends nothing."""
        if os.getpid() != self._pid:
            return
        self._ends.set()
        self._thread.join(_FAREWELL)
        self._recorder.put("left", time.monotonic_ns())
        ends_at = time.monotonic() + _FAREWELL
        self._send()
        while any(not each.is_up_to_date for each in self._consoles) and time.monotonic() < ends_at:
            time.sleep(_PERIOD)
            self._send()
        for console in self._consoles:
            console.close()
        for each in (*self._listeners, *(visitor.connection for visitor in self._visitors)):
            each.close()
        self._path.unlink(missing_ok=True)


def _user_of(connection: socket.socket) -> int:
    credentials = connection.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, 12)
    return int(struct.unpack("3i", credentials)[1])
