"""Which signals end a program's contexts, as far as a program may choose.

Here Ctrl-C always arrives as ``KeyboardInterrupt`` in the main thread, and SIGTERM ends the process; the
choice is kept for those who ask for it.
"""

from enum import IntFlag

from sim.ros.process import of_process


class SignalHandlerOptions(IntFlag):
    """The signals that rclpy may be asked to handle."""

    NO = 0
    SIGINT = 1
    SIGTERM = 2
    ALL = 3


class _Choice:
    """What a process chose."""

    def __init__(self) -> None:
        self.options = SignalHandlerOptions.NO


def install_signal_handlers(options: SignalHandlerOptions = SignalHandlerOptions.ALL) -> None:
    """Choose the signals.

    Raises:
        TypeError: ``options`` is no ``SignalHandlerOptions``.
    """
    if not isinstance(options, SignalHandlerOptions):
        raise TypeError(f"options must be a SignalHandlerOptions, not {options!r}")
    of_process(_Choice).options = options


def uninstall_signal_handlers() -> None:
    """Choose none."""
    of_process(_Choice).options = SignalHandlerOptions.NO


def get_current_signal_handlers_options() -> SignalHandlerOptions:
    """The signals that are chosen."""
    return of_process(_Choice).options
