"""Contexts: what ``rclpy.init`` begins and ``rclpy.shutdown`` ends."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from types import TracebackType

from sim.ros.arguments import Arguments, arguments_of_program
from sim.ros.exceptions import NotInitializedException
from sim.ros.host import Host
from sim.ros.probe import Probe
from sim.ros.process import current_process


class Context:
    """One program's stay on the network. Thread-safe.

    ``probe`` defaults to the process's, else the host's: what the nodes of this context do is on the trace.
    """

    def __init__(self, *, host: Host | None = None, probe: Probe | None = None) -> None:
        process = current_process()
        self.host = process.host if host is None else host
        self.probe = probe or process.probe or self.host.probe
        self.arguments = Arguments()
        self._initialized = False
        self._valid = False
        self._shutdown_callbacks: list[Callable[[], None]] = []

    def init(self, args: Sequence[str] | None = None, *, domain_id: int | None = None) -> None:
        """Begin; ``args`` None means the program's own arguments.

        Raises:
            RuntimeError: it was called before.
            ValueError: a negative domain id.
            RCLError, UnknownROSArgsError: a ROS argument cannot be read, or is none.
        """
        if domain_id is not None and domain_id < 0:
            raise ValueError(f"Domain id ({domain_id}) should not be lower than zero.")
        if self._initialized:
            raise RuntimeError("Context.init() must only be called once")
        arguments = arguments_of_program(sys.argv if args is None else args)
        with self.host.lock:
            self._initialized = True
            self._valid = True
            self.arguments = arguments
        arguments.set_log_levels()

    def ok(self) -> bool:
        """Whether it has begun and not ended."""
        return self._valid

    def shutdown(self) -> None:
        """End: every executor of this context stops spinning.

        Raises:
            RuntimeError: it had not begun, or has ended already.
        """
        with self.host.lock:
            if not self._valid:
                raise RuntimeError("Context must be initialized before it can be shutdown")
            self._valid = False
            callbacks, self._shutdown_callbacks = self._shutdown_callbacks, []
        for callback in callbacks:
            callback()

    def try_shutdown(self) -> None:
        """End, if that has not been done."""
        if self._valid:
            self.shutdown()

    def on_shutdown(self, callback: Callable[[], None]) -> None:
        """Have ``callback`` run when it ends.

        Raises:
            TypeError: it cannot be called.
        """
        if not callable(callback):
            raise TypeError("callback should be a callable, got {}", type(callback))
        with self.host.lock:
            if self._valid or not self._initialized:
                self._shutdown_callbacks.append(callback)
                return
        callback()

    def require_ok(self) -> None:
        """Raise NotInitializedException unless it has begun and not ended."""
        if not self._valid:
            raise NotInitializedException("cannot use Context")

    def __enter__(self) -> Context:
        if not self._initialized:
            self.init()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.try_shutdown()
