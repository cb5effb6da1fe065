"""Ctrl-C at any moment: critical sections are finished first, and only the exit code tells of it.

Python raises KeyboardInterrupt between any two steps of the main thread. In the middle of writing a chunk of
a recording that would leave half a chunk. All of this is for the main thread; on others nothing is raised.
"""

import signal
import sys
import threading
import time
import typing
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from types import FrameType
from typing import Any, TypeAlias

INTERRUPTED = 128 + signal.SIGINT
"""The exit code of a command that was interrupted."""
ENDING: Sequence[signal.Signals] = [
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)
]
"""What a command is told to end by: Ctrl-C, ``kill``, and a terminal that is closed."""

_RETRY = 0.005
"""Seconds after which an interruption is tried again."""
_IMPORT_TIMEOUT = 2.0
"""Seconds that something may take to be imported; a lesson's checks can be anything."""
_FRAGILE = ("<frozen importlib._bootstrap>", typing.__file__)
"""Where the code is of what is imported, and of what libraries in C ask about types."""

_Handler: TypeAlias = Callable[[int, FrameType | None], Any]


class Interruption:
    """A deferred Ctrl-C: whether it has come."""

    def __init__(self) -> None:
        self.came = False

    def __call__(self, _number: int, _frame: FrameType | None) -> None:
        """Note that it came."""
        self.came = True


@contextmanager
def deferred_interrupt() -> Iterator[Interruption]:
    """Defer Ctrl-C to the end of the block, which is short or checks whether Ctrl-C came."""
    waiting = Interruption()
    if threading.current_thread() is not threading.main_thread():
        yield waiting
        return
    before = signal.signal(signal.SIGINT, waiting)
    try:
        yield waiting
    finally:
        signal.signal(signal.SIGINT, before)
        if waiting.came:
            signal.raise_signal(signal.SIGINT)


@contextmanager
def ending_signals_on_loop(tell: Callable[[signal.Signals], None]) -> Iterator[None]:
    """Have the running event loop call ``tell`` at each of ``ENDING``; what Ctrl-C did before, it does after.

    The loop by itself leaves Python's own way with Ctrl-C behind, which breaks off what it comes upon.
    """
    import asyncio  # when the console opens: other commands need none of it

    loop, before = asyncio.get_running_loop(), signal.getsignal(signal.SIGINT)
    if not hasattr(signal, "pthread_sigmask"):  # Windows: its loop hears no signals
        yield
        return
    for number in ENDING:
        loop.add_signal_handler(number, tell, number)
    try:
        yield
    finally:
        blocked = signal.pthread_sigmask(signal.SIG_BLOCK, ENDING)
        for number in ENDING:
            loop.remove_signal_handler(number)
        signal.signal(signal.SIGINT, before)
        signal.pthread_sigmask(signal.SIG_SETMASK, blocked)


@contextmanager
def ending_signals(tell: Callable[[signal.Signals], None]) -> Iterator[None]:
    """Have ``tell`` called, on the main thread, at the first of ``ENDING``; the next is KeyboardInterrupt.

    A signal that is ignored, as under ``nohup``, stays ignored.
    """
    first = True

    def handle(number: int, _frame: FrameType | None) -> None:
        nonlocal first
        if not first:
            raise KeyboardInterrupt
        first = False
        tell(signal.Signals(number))

    if threading.current_thread() is not threading.main_thread():
        yield
        return
    wanted = [number for number in ENDING if signal.getsignal(number) != signal.SIG_IGN]
    before = [(number, signal.signal(number, handle)) for number in wanted]
    try:
        yield
    finally:
        for number, handler in before:
            signal.signal(number, handler)


def install() -> None:
    """Have Ctrl-C raise KeyboardInterrupt where something comes of it, and else a moment later.

    Libraries in C are not made for exceptions while they are imported or look at types (msgspec crashes, or
    forgets them), and what is raised as an object goes is printed and forgotten.
    """
    if signal.getsignal(signal.SIGINT) == signal.SIG_IGN or not hasattr(signal, "setitimer"):
        return
    usual = sys.unraisablehook

    def hook(unraisable: Any) -> None:
        if issubclass(unraisable.exc_type, KeyboardInterrupt):
            _try_again_soon()
        else:
            usual(unraisable)

    sys.unraisablehook = hook
    signal.signal(signal.SIGALRM, lambda *_: signal.raise_signal(signal.SIGINT))
    signal.signal(signal.SIGINT, _InterruptHandler())


class _InterruptHandler:
    """Raises KeyboardInterrupt, though not in the middle of what does not bear it."""

    def __init__(self) -> None:
        self._since: float | None = None

    def __call__(self, _number: int, frame: FrameType | None) -> None:
        now = time.monotonic()
        self._since = self._since or now
        if _is_fragile(frame) and now - self._since < _IMPORT_TIMEOUT:
            _try_again_soon()
        else:
            self._since = None
            raise KeyboardInterrupt


def _is_fragile(frame: FrameType | None) -> bool:
    while frame is not None:
        if frame.f_code.co_filename in _FRAGILE:
            return True
        frame = frame.f_back
    return False


def _try_again_soon() -> None:
    signal.setitimer(signal.ITIMER_REAL, _RETRY)


def ignore() -> None:
    """Ignore Ctrl-C from now on, as the process is about to exit."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if hasattr(signal, "setitimer"):
        signal.signal(signal.SIGALRM, signal.SIG_IGN)  # Python puts what ends a process there as it ends
