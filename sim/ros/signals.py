"""Which signals end a program's contexts, as far as a program may choose.

Here Ctrl-C always arrives as ``KeyboardInterrupt`` in the main thread, and SIGTERM ends the process; the
choice is kept for those who ask for it.
"""

from enum import IntFlag


class SignalHandlerOptions(IntFlag):
    """The signals that rclpy may be asked to handle."""

    NO = 0
    SIGINT = 1
    SIGTERM = 2
    ALL = 3


_chosen = [SignalHandlerOptions.NO]


def install_signal_handlers(options: SignalHandlerOptions = SignalHandlerOptions.ALL) -> None:
    """Choose the signals.

    Raises:
        TypeError: ``options`` is no ``SignalHandlerOptions``.
    """
    if not isinstance(options, SignalHandlerOptions):
        raise TypeError(f"options must be a SignalHandlerOptions, not {options!r}")
    _chosen[0] = options


def uninstall_signal_handlers() -> None:
    """Choose none."""
    _chosen[0] = SignalHandlerOptions.NO


def get_current_signal_handlers_options() -> SignalHandlerOptions:
    """The signals that are chosen."""
    return _chosen[0]
