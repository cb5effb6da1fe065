"""Signals that end a program's contexts: SIGINT (Ctrl-C) and SIGTERM.

If the model is used as a plain library, real handlers are installed, as in rclpy; they end the contexts and
then call the former handler, which for Ctrl-C raises ``KeyboardInterrupt`` in the main thread. In an
engine, which hosts several programs, the sender of a signal calls ``deliver_sigint``.
"""

import signal
import threading
from enum import IntFlag
from types import FrameType
from typing import Any

from sim.ros.context.context import end_contexts_by_signal
from sim.ros.middleware.process import Process, current_process

__all__ = [
    "SignalHandlerOptions",
    "deliver_sigint",
    "deliver_sigterm",
    "get_current_signal_handlers_options",
    "install_signal_handlers",
    "uninstall_signal_handlers",
]


class SignalHandlerOptions(IntFlag):
    """The signals that rclpy handles."""

    NO = 0
    SIGINT = 1
    SIGTERM = 2
    ALL = 3


_SIGNALS = {SignalHandlerOptions.SIGINT: signal.SIGINT, SignalHandlerOptions.SIGTERM: signal.SIGTERM}


class _Handling:
    """The signals that a process handles, and the installed handlers."""

    def __init__(self) -> None:
        self.options = SignalHandlerOptions.NO
        self.handlers: list[_Handler] = []


class _Handler:
    """Handles a signal of the operating system for a process until it is removed."""

    def __init__(self, process: Process, option: SignalHandlerOptions) -> None:
        self._process = process
        self._option = option
        self._number = _SIGNALS[option]
        self._before: Any = signal.signal(self._number, self.handle)

    def handle(self, number: int, frame: FrameType | None) -> None:
        """End the contexts, if the process still handles the signal, and call the former handler."""
        if self._option in self._process.local(_Handling).options:
            end_contexts_by_signal(self._process)
        if callable(self._before):
            self._before(number, frame)

    def remove(self) -> None:
        """Restore the former handler, unless the program has installed another one."""
        if signal.getsignal(self._number) == self.handle:
            signal.signal(self._number, self._before)


def install_signal_handlers(options: SignalHandlerOptions = SignalHandlerOptions.ALL) -> None:
    """Handle these signals, too.

    Python installs handlers only in the main thread; on other threads only the options are stored.

    Raises:
        TypeError: ``options`` is not a ``SignalHandlerOptions``.
    """
    if not isinstance(options, SignalHandlerOptions):
        raise TypeError(f"options must be a SignalHandlerOptions, not {options!r}")
    process = current_process()
    own = process.local(_Handling)
    if process.host.takes_signals and _in_main_thread():
        for each in _SIGNALS:
            if each in options and each not in own.options:
                own.handlers.append(_Handler(process, each))
    own.options |= options


def uninstall_signal_handlers() -> None:
    """Stop handling signals."""
    own = current_process().local(_Handling)
    own.options = SignalHandlerOptions.NO
    if _in_main_thread():
        handlers, own.handlers = own.handlers, []
        for each in reversed(handlers):
            each.remove()


def get_current_signal_handlers_options() -> SignalHandlerOptions:
    """The signals that are handled."""
    return current_process().local(_Handling).options


def deliver_sigint(process: Process) -> bool:
    """Do what rclpy does at SIGINT: if a process handles the signal, end all its contexts; return whether.

    Thread-safe. The caller has to raise the ``KeyboardInterrupt`` of Python in the program's main thread.
    """
    return _deliver(SignalHandlerOptions.SIGINT, process)


def deliver_sigterm(process: Process) -> bool:
    """Do what rclpy does at SIGTERM, as ``deliver_sigint``; if False, the signal would kill the process."""
    return _deliver(SignalHandlerOptions.SIGTERM, process)


def _deliver(option: SignalHandlerOptions, process: Process) -> bool:
    handled = option in process.local(_Handling).options
    if handled:
        end_contexts_by_signal(process)
    return handled


def _in_main_thread() -> bool:
    return threading.current_thread() is threading.main_thread()
