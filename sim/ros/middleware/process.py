"""Simulated processes: a program's arguments, and the state that rclpy keeps in global variables.

Programs that would be separate processes on a real machine run on threads of one process. Each has its own
default context, global executor, loggers and arguments: ``process_local`` keeps rclpy's global variables per
process. A thread belongs to the process of the thread that started it.
"""

import os
import sys
import threading
from collections import UserList
from collections.abc import Callable, Generator, Iterator, Mapping, MutableMapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import count
from typing import Any, Self, SupportsIndex, TypeVar
from weakref import WeakMethod

from sim.probes.probe import Probe
from sim.ros.middleware.endpoints import ContextLifetime
from sim.ros.middleware.host import Host, current_host

LocalT = TypeVar("LocalT")


@dataclass(eq=False)
class Process:
    """One program on the host. Thread-safe.

    ``number`` and ``label`` identify it on the trace (0 and empty for a single one). ``arguments`` is its
    ``sys.argv``; ``environment`` has the variables that differ from the machine's. ``probe`` None: the
    host's. ``shows_stdout``: whether its output is shown. ``output_sink(line, is_error)`` gets every line
    that it prints or logs, instead of the run; None: the run gets the lines. ``output_listener`` also gets
    the lines, shown or not. ``has_keyboard``: whether it reads the run's terminal. ``default_context`` is
    None before its first use and after its end. ``pool_numbers`` numbers the thread pools; ``callbacks`` and
    ``spins`` count the callbacks made and the spins started, ``spinning`` the spins that have not ended;
    ``shut_down_at`` is the place of the callback that shut rclpy down, or empty. ``finish_pools`` wait until
    the workers of the pools are idle.
    """

    host: Host
    number: int = 0
    label: str = ""
    arguments: list[str] = field(default_factory=lambda: list(sys.argv))
    environment: dict[str, str] = field(default_factory=dict)
    probe: Probe | None = None
    shows_stdout: bool = True
    output_sink: Callable[[str, bool], None] | None = None
    output_listener: Callable[[str, bool], None] | None = None
    has_keyboard: bool = True
    default_context: ContextLifetime | None = None
    pool_numbers: Iterator[int] = field(default_factory=count)
    callbacks: int = 0
    spins: int = 0
    spinning: int = 0
    shut_down_at: str = ""
    finish_pools: list[WeakMethod[Callable[[], None]]] = field(default_factory=list)
    _locals: dict[Callable[[], Any], Any] = field(default_factory=dict)

    def local(self, make: Callable[[], LocalT]) -> LocalT:
        """The process's own result of ``make``, which is called at the first access."""
        if make not in self._locals:
            with self.host.lock:
                self._locals.setdefault(make, make())
        value: LocalT = self._locals[make]
        return value

    @contextmanager
    def spin(self) -> Generator[None, None, None]:
        """Count a spin of one of its executors while it lasts; thread-safe."""
        with self.host.lock:
            self.spins += 1
            self.spinning += 1
        try:
            yield
        finally:
            with self.host.lock:
                self.spinning -= 1

    def enter(self) -> None:
        """Assign the calling thread, and the threads that it starts later, to this process."""
        _here().ros_process = self

    def start_thread(self, target: Callable[[], None], name: str) -> None:
        """Run ``target`` on a new thread of this process, on the host's time."""

        def run() -> None:
            self.enter()
            target()

        self.host.clock.start_thread(run, name)


_main: Process | None = None


def current_process() -> Process:
    """The process of the calling thread; by default the host's main process."""
    return process_of(_here())


def process_of(thread: threading.Thread) -> Process:
    """The process of a thread."""
    process: Process | None = getattr(thread, "ros_process", None)
    return _main_process() if process is None else process


def process_local(make: Callable[[], LocalT]) -> LocalT:
    """The result of ``make`` for the calling thread's process; ``make`` is called at the first access."""
    return current_process().local(make)


def _main_process() -> Process:
    global _main  # noqa: PLW0603 -- one main process per host
    host = current_host()
    if _main is None or _main.host is not host:
        _main = Process(host)
    return _main


def _here() -> Any:
    return threading.current_thread()


def simulate_processes() -> None:
    """Prepare this process for several simulated ones.

    Threads inherit their process; ``sys.argv`` and the changed variables of ``os.environ`` are those of the
    simulated process, and so are the numbers of Python's thread pools. Other threads keep the present
    arguments. Call it once, with the host installed.
    """
    _main_process()
    make: Any = threading.Thread.__init__

    def make_inheriting(thread: Any, *args: Any, **kwargs: Any) -> None:
        make(thread, *args, **kwargs)
        thread.ros_process = getattr(_here(), "ros_process", None)

    thread_class: Any = threading.Thread
    thread_class.__init__ = make_inheriting
    pool_class: Any = ThreadPoolExecutor
    pool_class._counter = staticmethod(lambda: next(current_process().pool_numbers))
    sys.argv = _Arguments()  # type: ignore[assignment]
    os.environ = _Environment(os.environ)  # type: ignore[assignment]  # noqa: B003 -- nothing is to be cleared


class _Arguments(UserList[str]):
    """The arguments of the calling thread's process."""

    def __init__(self) -> None:
        """Copy nothing: each process has its own arguments."""

    @property
    def data(self) -> list[str]:  # type: ignore[override]
        """The arguments of the calling thread's process."""
        return current_process().arguments

    def __getitem__(self, index: SupportsIndex | slice) -> Any:
        return self.data[index]

    def copy(self) -> list[str]:  # type: ignore[override]
        """The arguments as a plain list."""
        return list(self.data)


class _Environment(MutableMapping[str, str]):
    """The environment of the calling thread's process: the machine's variables and its own."""

    def __init__(self, machine: MutableMapping[str, str]) -> None:
        self._machine = machine

    def _own(self) -> dict[str, str]:
        return current_process().environment

    def __getitem__(self, name: str) -> str:
        own = self._own()
        return own[name] if name in own else self._machine[name]

    def __setitem__(self, name: str, value: str) -> None:
        self._own().pop(name, None)
        self._machine[name] = value

    def __delitem__(self, name: str) -> None:
        if self._own().pop(name, None) is None:
            del self._machine[name]

    def __iter__(self) -> Iterator[str]:
        return iter({**self._machine, **self._own()})

    def __len__(self) -> int:
        return len({**self._machine, **self._own()})

    def __or__(self, other: Mapping[str, str]) -> dict[str, str]:
        return {**self, **other}

    def __ror__(self, other: Mapping[str, str]) -> dict[str, str]:
        return {**other, **self}

    def __ior__(self, other: Mapping[str, str]) -> Self:
        self.update(other)
        return self

    def copy(self) -> dict[str, str]:
        """The environment as a plain dictionary."""
        return dict(self)
