"""Waits for files, pipes and sockets on virtual time: each call checks first whether it would block."""

import contextlib
import fcntl
import io
import multiprocessing.connection
import multiprocessing.synchronize
import os
import select
import selectors
import socket
import stat
from collections.abc import Callable
from typing import Any

from sim.clock.outside_work import OutsideWork
from sim.clock.replacing import Replacements

_poll = select.poll


def replace_descriptors(replacements: Replacements, outside: OutsideWork) -> None:
    """Replace waits for descriptors: virtual time passes as real time meanwhile, and other threads run."""
    _replace_polls(replacements, outside)
    _replace_files(replacements, outside)
    _replace_sockets(replacements, outside)
    _replace_locks(replacements, outside)


def _replace_polls(replacements: Replacements, outside: OutsideWork) -> None:
    owns = replacements.clock.owns_current_thread
    real_select = select.select

    def select_(readers: Any, writers: Any, others: Any, timeout: float | None = None) -> Any:
        if timeout is not None and timeout < 0:
            raise ValueError("timeout must be non-negative")
        readers, writers, others = [*readers], [*writers], [*others]

        def look() -> Any:
            ready = real_select(readers, writers, others, 0)
            return ready if any(ready) else None

        return outside.wait(look, timeout, "select.select") or ([], [], [])

    class Poll(_Wrapped):
        """``select.poll``."""

        make = staticmethod(_poll)

        def poll(self, timeout: float | None = None) -> Any:
            if not owns():
                return self.real.poll(timeout)
            seconds = None if timeout is None or timeout < 0 else timeout / 1e3
            return outside.wait(lambda: self.real.poll(0), seconds, "select.poll")

    replacements.put(select, "select", select_)
    selects: Any = select
    kinds: Any = selectors
    selects.poll = kinds.PollSelector._selector_cls = Poll
    kinds.SelectSelector._select = staticmethod(select.select)
    if not hasattr(select, "epoll"):  # only Linux has it
        return

    class Epoll(_Wrapped):
        """``select.epoll``."""

        make = staticmethod(select.epoll)
        fromfd = staticmethod(select.epoll.fromfd)

        def poll(self, timeout: float | None = None, maxevents: int = -1) -> Any:
            if not owns():
                return self.real.poll(timeout, maxevents)
            seconds = None if timeout is None or timeout < 0 else timeout
            return outside.wait(lambda: self.real.poll(0, maxevents), seconds, "select.epoll")

    selects.epoll = kinds.EpollSelector._selector_cls = Epoll


class _Wrapped:
    """Wraps a polling object of the system, whose type allows no subclasses."""

    make: Callable[..., Any]

    def __init__(self, *arguments: Any, **named: Any) -> None:
        self.real = self.make(*arguments, **named)

    def __getattr__(self, name: str) -> Any:
        return getattr(self.real, name)

    def __enter__(self) -> Any:
        return self

    def __exit__(self, *_error: object) -> None:
        self.real.close()


def _replace_files(replacements: Replacements, outside: OutsideWork) -> None:
    owns = replacements.clock.owns_current_thread
    read, write, real_open = os.read, os.write, io.open

    def await_ready(descriptor: int, events: int, what: str) -> None:
        if _may_block(descriptor):
            outside.wait(lambda: _ready(descriptor, events), None, what)

    def read_ready(descriptor: int, size: int) -> bytes:
        await_ready(descriptor, select.POLLIN, "os.read")
        return read(descriptor, size)

    def write_ready(descriptor: int, data: Any) -> int:
        if not _may_block(descriptor):
            return write(descriptor, data)
        left = memoryview(data).cast("B")
        while left:
            await_ready(descriptor, select.POLLOUT, "os.write")
            left = left[write(descriptor, left[: select.PIPE_BUF]) :]
        return memoryview(data).nbytes

    class Pipe(io.FileIO):
        """An end of a pipe."""

        def readinto(self, buffer: Any) -> Any:
            if owns():
                await_ready(self.fileno(), select.POLLIN, "reading a pipe")
            return super().readinto(buffer)

        def read(self, size: int | None = -1) -> Any:
            return io.RawIOBase.read(self, -1 if size is None else size)

        def readall(self) -> bytes:
            return b"".join(iter(lambda: io.RawIOBase.read(self, io.DEFAULT_BUFFER_SIZE), b""))

        def write(self, data: Any) -> Any:
            if not owns():
                return super().write(data)
            await_ready(self.fileno(), select.POLLOUT, "writing to a pipe")
            return super().write(memoryview(data).cast("B")[: select.PIPE_BUF])

    def open_(file: Any, mode: str = "r", buffering: int = -1, *rest: Any, **named: Any) -> Any:
        if not isinstance(file, int) or not {*mode} <= {*"rwbt"} or not _may_block(file):
            return real_open(file, mode, buffering, *rest, **named)
        raw = Pipe(file, mode.replace("t", ""), named.pop("closefd", True))
        if buffering == 0:
            return raw
        buffered = io.BufferedReader if "r" in mode else io.BufferedWriter
        binary = buffered(raw, buffering if buffering > 1 else io.DEFAULT_BUFFER_SIZE)
        if "b" in mode:
            return binary
        return io.TextIOWrapper(binary, *rest, line_buffering=buffering == 1, **named)  # type: ignore[misc]

    replacements.put(os, "read", read_ready)
    replacements.put(os, "write", write_ready)
    replacements.put(io, "open", open_)
    connection: Any = multiprocessing.connection.Connection
    connection._recv.__defaults__ = (os.read,)


def _may_block(descriptor: int) -> bool:
    """Whether reading or writing may wait: the descriptor is a blocking pipe, socket or terminal."""
    with contextlib.suppress(OSError):
        mode = os.fstat(descriptor).st_mode
        waits = stat.S_ISFIFO(mode) or stat.S_ISSOCK(mode) or os.isatty(descriptor)
        return waits and os.get_blocking(descriptor)
    return False


def _ready(descriptor: int, events: int) -> bool:
    poller = _poll()
    poller.register(descriptor, events)
    return bool(poller.poll(0))


def _replace_sockets(replacements: Replacements, outside: OutsideWork) -> None:
    owns = replacements.clock.owns_current_thread
    own_class: Any = socket.socket

    def waiting(name: str, events: int) -> Callable[..., Any]:
        real = getattr(own_class, name)
        what = f"socket.{name.strip('_')}"

        def ready(sock: socket.socket, *arguments: Any, **named: Any) -> Any:
            timeout = sock.gettimeout()
            may_wait = owns() and timeout != 0 and sock.fileno() >= 0
            if may_wait and not outside.wait(lambda: _ready(sock.fileno(), events), timeout, what):
                raise TimeoutError("timed out")
            return real(sock, *arguments, **named)

        return ready

    def sendall(sock: socket.socket, data: Any, flags: int = 0) -> None:
        if not owns() or sock.gettimeout() == 0:
            real_sendall(sock, data, flags)
            return
        left = memoryview(data).cast("B")
        while left:
            left = left[sock.send(left[:65536], flags | socket.MSG_DONTWAIT) :]

    def connect(sock: socket.socket, address: Any) -> None:
        timeout = sock.gettimeout()
        if not owns() or timeout == 0:
            real_connect(sock, address)
            return
        outside.tell("socket.connect reaches outside the run, which answers when it likes")
        sock.setblocking(False)
        try:
            real_connect(sock, address)
        except BlockingIOError:
            if not outside.wait(lambda: _ready(sock.fileno(), select.POLLOUT), timeout, "socket.connect"):
                raise TimeoutError("timed out") from None
            if number := sock.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR):
                raise OSError(number, os.strerror(number)) from None
        finally:
            sock.settimeout(timeout)

    real_sendall, real_connect = own_class.sendall, own_class.connect
    for name in ("recv", "recv_into", "recvfrom", "recvfrom_into", "recvmsg", "recvmsg_into", "_accept"):
        setattr(own_class, name, waiting(name, select.POLLIN))
    for name in ("send", "sendto", "sendmsg"):
        setattr(own_class, name, waiting(name, select.POLLOUT))
    own_class.sendall, own_class.connect = sendall, connect
    for name in ("getaddrinfo", "gethostbyname", "gethostbyname_ex", "gethostbyaddr", "getnameinfo"):
        real = getattr(socket, name)
        replacements.put(
            socket,
            name,
            lambda *given, real=real, name=name, **named: outside.call(
                real, *given, what=f"socket.{name}", **named
            ),
        )


def _replace_locks(replacements: Replacements, outside: OutsideWork) -> None:
    owns = replacements.clock.owns_current_thread

    def trying(lock: Callable[..., Any], what: str) -> Callable[..., Any]:
        def lock_(file: Any, kind: int, *rest: Any) -> Any:
            if kind & (fcntl.LOCK_NB | fcntl.LOCK_UN):
                return lock(file, kind, *rest)

            def look() -> bool:
                try:
                    lock(file, kind | fcntl.LOCK_NB, *rest)
                except BlockingIOError:
                    return False
                return True

            outside.wait(look, None, what)
            return None

        return lock_

    for name in ("flock", "lockf"):
        replacements.put(fcntl, name, trying(getattr(fcntl, name), f"fcntl.{name}"))
    semaphores: Any = multiprocessing.synchronize.SemLock
    make_methods = semaphores._make_methods

    def make_waiting(semaphore: Any) -> None:
        make_methods(semaphore)
        acquire = semaphore.acquire

        def acquire_in_turn(block: bool = True, timeout: float | None = None) -> bool:
            if not block or not owns():
                return bool(acquire(block, timeout))
            return outside.wait(lambda: bool(acquire(False)), timeout, "a lock of multiprocessing")

        semaphore.acquire = acquire_in_turn

    semaphores._make_methods = make_waiting
    semaphores.__enter__ = lambda semaphore: semaphore.acquire()
