"""Ctrl-C at any moment: critical sections are completed first, and the exit code reports the interrupt.

Python raises KeyboardInterrupt between any two bytecodes of the main thread; inside the write of a
recording's chunk it would leave half a chunk. On other threads nothing is raised.
"""

import enum
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
"""The exit code of an interrupted command."""
ENDING: Sequence[signal.Signals] = [
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)
]
"""The signals that end a command: Ctrl-C, ``kill``, and a closed terminal."""

_RETRY = 0.005
"""Seconds until a postponed interrupt is raised again."""
_IMPORT_TIMEOUT = 2.0
"""Seconds for which an import postpones an interrupt; a lesson's checks may import anything."""
_FRAGILE = ("<frozen importlib._bootstrap>", typing.__file__, enum.__file__)
"""Files whose code must not be interrupted: the import system, and what C libraries call for types."""

_Handler: TypeAlias = Callable[[int, FrameType | None], Any]


class Interruption:
    """A deferred Ctrl-C; ``came`` tells whether there was one."""

    def __init__(self) -> None:
        self.came = False

    def __call__(self, _number: int, _frame: FrameType | None) -> None:
        """Note the signal."""
        self.came = True


@contextmanager
def deferred_interrupt() -> Iterator[Interruption]:
    """Defer Ctrl-C to the end of the block, which is short or polls ``came``."""
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
    """Call ``tell`` on the running event loop for each signal of ``ENDING``; restores the handler of Ctrl-C.

    ``remove_signal_handler`` alone would leave Python's default handler, which raises at any bytecode.
    """
    import asyncio  # imported late: only the console needs it

    loop, before = asyncio.get_running_loop(), signal.getsignal(signal.SIGINT)
    if not hasattr(signal, "pthread_sigmask"):  # Windows: its loop handles no signals
        yield
        return
    for number in ENDING:
        loop.add_signal_handler(number, tell, number)
    try:
        yield
    finally:
        came: list[int] = []
        blocked = signal.pthread_sigmask(signal.SIG_BLOCK, ENDING)
        for number in ENDING:  # other threads still take signals, and nobody reads what the loop is told
            signal.signal(number, lambda number, _: came.append(number))
        for number in ENDING:
            loop.remove_signal_handler(number)
        signal.signal(signal.SIGINT, before)
        signal.pthread_sigmask(signal.SIG_SETMASK, blocked)
        for each in came:
            signal.raise_signal(each)


@contextmanager
def ending_signals(tell: Callable[[signal.Signals], None]) -> Iterator[None]:
    """Call ``tell`` on the main thread at the first signal of ``ENDING``; the next raises KeyboardInterrupt.

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
    """Raise KeyboardInterrupt on Ctrl-C where that is safe, and otherwise a moment later.

    C libraries do not expect exceptions while they are imported or inspect types (msgspec crashes or swallows
    them), and an exception in a destructor is printed and lost.
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
    """Raises KeyboardInterrupt, except inside fragile code."""

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
    """Ignore Ctrl-C from now on, as the process is about to exit; raises one that was postponed until now."""
    is_postponed = hasattr(signal, "setitimer") and signal.setitimer(signal.ITIMER_REAL, 0)[0] > 0
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if hasattr(signal, "SIGALRM"):
        signal.signal(signal.SIGALRM, signal.SIG_IGN)  # at exit Python restores the deadly default
    if is_postponed:
        raise KeyboardInterrupt
