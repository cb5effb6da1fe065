"""Contexts, which ``rclpy.init`` initialises and ``rclpy.shutdown`` ends."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Sequence
from inspect import ismethod
from typing import Any, NamedTuple
from weakref import WeakMethod, ref

from sim.probes.own_code import place_of_caller
from sim.probes.probe import Probe
from sim.ros.context.arguments import Arguments, arguments_of_program, is_for_any
from sim.ros.exceptions import RCLError
from sim.ros.handle import Handle
from sim.ros.middleware.domain import DOMAIN_VARIABLE, domain_of
from sim.ros.middleware.host import Host, current_host
from sim.ros.middleware.network import Network
from sim.ros.middleware.process import Process, current_process

ENDED = "the given context is not valid, either rcl_init() was not called or rcl_shutdown() was called."
NODE_ENDED = "rcl node's context is invalid"
"""rcl's messages for a context that has ended, and for a node of such a context."""
_NO_INIT = "rclpy.init() has not been called"


class _EndCallback(NamedTuple):
    """A callback for the end of a context; ``by_signal``: also when a signal ends the context."""

    get: Callable[[], Callable[[], None] | None]
    by_signal: bool


class _ActiveContexts:
    """The contexts of a process that are initialised and have not ended."""

    def __init__(self) -> None:
        self.contexts: list[ref[Context]] = []


class Context:
    """rclpy's context: a program's connection to the network. Thread-safe.

    It belongs to the process that creates it; with a host or a probe it gets a process of its own.
    """

    def __init__(self, *, host: Host | None = None, probe: Probe | None = None) -> None:
        own = host is not None or probe is not None
        self.process = Process(host or current_host(), probe=probe) if own else current_process()
        self.host = self.process.host
        self.probe = self.process.probe or self.host.probe
        self.arguments = Arguments()
        self._initialized = False
        self._valid = False
        self._domain_id = self.host.default_domain
        self._network = self.host.network
        self._end_callbacks: list[_EndCallback] = []

    def init(self, args: Sequence[str] | None = None, *, domain_id: int | None = None) -> None:
        """Initialise the context; ``args`` None means the program's own arguments.

        Raises:
            RuntimeError: ``init`` was called before, or the domain id is negative.
            RCLError, UnknownROSArgsError: a ROS argument cannot be read, or is unknown; or ``ROS_DOMAIN_ID``,
                which is used without a ``domain_id``, is not a number.
        """
        if domain_id is not None and domain_id < 0:
            raise RuntimeError(f"Domain id ({domain_id}) should not be lower than zero.")
        if self._initialized:
            raise RuntimeError("Context.init() must only be called once")
        arguments = arguments_of_program(sys.argv if args is None else args)
        domain = self._domain_of_environment() if domain_id is None else domain_id
        with self.host.lock:
            self._initialized = True
            self._valid = True
            self.arguments = arguments
            self._domain_id = domain
            self._network = self.host.network_of(domain)
            active = self.process.local(_ActiveContexts)
            alive = (each for each in active.contexts if (other := each()) is not None and other.ok())
            active.contexts = [*alive, ref(self)]
        arguments.configure_logging()

    def _domain_of_environment(self) -> int:
        own = self.process.environment
        return domain_of(own if DOMAIN_VARIABLE in own else os.environ)

    @property
    def handle(self) -> Handle:
        """A handle that keeps the context alive while it is used."""
        return Handle(self)

    @property
    def destroyed(self) -> bool:
        """Whether the context has ended, or is not initialised yet."""
        return not self._valid

    def destroy(self) -> None:
        """End the context, unless it has ended."""
        self.try_shutdown()

    def get_domain_id(self) -> int:
        """The id of the context's domain; RuntimeError if the context is not initialised."""
        if not self._initialized:
            raise RuntimeError("Context must be initialized before it can have a domain id")
        return self._domain_id

    @property
    def network(self) -> Network:
        """The network of the context's domain; before ``init``, that of the default domain."""
        return self._network

    def ok(self) -> bool:
        """Whether the context is initialised and has not ended."""
        return self._valid

    def shutdown(self) -> None:
        """End the context: all its executors stop spinning.

        Raises:
            RuntimeError: the context is not initialised.
            RCLError: the context has ended already.
        """
        with self.host.lock:
            if not self._initialized:
                raise RuntimeError("Context must be initialized before it can be shutdown")
            if not self._valid:
                raise RCLError("failed to shutdown: rcl_shutdown already called on the given context")
            if self.probe.callback_here():
                self.process.shut_down_at = place_of_caller()
            if self.host.profile.ends_nodes_with_context:
                for node in self._network.nodes():
                    if node.context is self:
                        node.destroy_node()
            callbacks = self._end()
        for each in callbacks:
            _call(each)

    def warn_of_unused_parameters(self) -> None:
        """Warn once of arguments with parameters for no node that there is; call it when nodes are spun."""
        sources, self.arguments.parameter_sources = self.arguments.parameter_sources, {}
        if sources:
            nodes = [each for each in self._network.nodes() if each.context is self]
            names = [each.get_fully_qualified_name() for each in nodes]
            for source, asked in sources.items():
                if not is_for_any(asked, names):
                    self.probe.usage.parameters_unused(source, asked, names)

    def _end(self) -> list[_EndCallback]:
        """End the context, and return the callbacks to call. Called with the host's lock held."""
        self._valid = False
        callbacks, self._end_callbacks = self._end_callbacks, []
        return callbacks

    def _end_by_signal(self) -> None:
        """End the context as rclpy's signal handler does: only waiting code is notified."""
        with self.host.lock:
            callbacks = self._end() if self._valid else []
        for each in callbacks:
            if each.by_signal:
                _call(each)

    def try_shutdown(self) -> None:
        """End the context, unless it has ended."""
        if self._valid:
            self.shutdown()

    def on_shutdown(self, callback: Callable[[], None]) -> None:
        """Call ``callback`` at a shutdown, but not at a signal; bound methods are held weakly.

        Raises:
            TypeError: ``callback`` is not callable.
        """
        if not callable(callback):
            raise TypeError("callback should be a callable, got {}", type(callback))
        self._call_at_end(callback, by_signal=False)

    def wake_at_end(self, callback: Callable[[], None]) -> None:
        """Call ``callback``, a bound method that is held weakly, at every end of the context."""
        self._call_at_end(callback, by_signal=True)

    def _call_at_end(self, callback: Callable[[], None], *, by_signal: bool) -> None:
        with self.host.lock:
            if self._valid or not self._initialized:
                get = WeakMethod(callback, self._forget) if ismethod(callback) else lambda: callback
                self._end_callbacks.append(_EndCallback(get, by_signal))
                return
        callback()

    def _forget(self, reference: WeakMethod[Any]) -> None:
        self._end_callbacks = [each for each in self._end_callbacks if each.get is not reference]

    def require_initialized(self, refused: str) -> None:
        """Raise RuntimeError or TypeError (by the release) before ``init``, and RCLError after the end."""
        if self._initialized:
            self.require_ok(refused)
            return
        if self.host.profile.tells_missing_init:
            raise RuntimeError(f"Context must be initialized a GuardCondition can be created: {_NO_INIT}")
        raise TypeError(f"'NoneType' object does not support the context manager protocol: {_NO_INIT}")

    def require_ok(self, refused: str, reason: str = ENDED) -> None:
        """Raise RCLError with the refused action and the reason, unless the context is ``ok``."""
        if not self._valid:
            raise RCLError(f"{refused}: {reason}")

    def __enter__(self) -> Context:
        if not self._initialized:
            self.init()
        return self

    def __exit__(self, *_error: object) -> None:
        self.try_shutdown()


def end_contexts_by_signal(process: Process) -> None:
    """End all contexts of a process as rclpy's signal handler does."""
    for reference in tuple(process.local(_ActiveContexts).contexts):
        context = reference()
        if context is not None:
            context._end_by_signal()


def _call(end_callback: _EndCallback) -> None:
    callback = end_callback.get()
    if callback is not None:
        callback()
