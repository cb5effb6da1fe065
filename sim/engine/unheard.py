"""Tells of exceptions that Python itself only prints: those of threads, destructors and exit handlers."""

import sys
import threading
from collections.abc import Callable
from typing import Any

from sim.clock import Stopped
from sim.engine.failure import place_of
from sim.error_text import error_text

Tell = Callable[[str], None]


def tell_of_unheard(tell: Tell, path: str, folder: str) -> None:
    """Have ``tell`` called with a sentence for each line they come from; they are printed as before.

    ``path`` is the program's file; files in ``folder`` count as the learner's own too. What came up in none
    of these is only printed.
    """
    print_thread, print_other = threading.excepthook, sys.unraisablehook
    told: set[str] = set()

    def say(error: BaseException, what_follows: str) -> None:
        place = place_of(error, path, folder).strip(" ()")
        if place and place not in told:
            told.add(place)
            text = f"{type(error).__name__}: {error_text(error)}".removesuffix(": ")
            tell(f"{place}: {text}; {what_follows}")

    def of_thread(failed: threading.ExceptHookArgs) -> None:
        error = failed.exc_value
        if not isinstance(error, Stopped | SystemExit | KeyboardInterrupt | None):
            name = "a thread" if failed.thread is None else failed.thread.name
            say(error, f"{name} ended by it, and the rest goes on")
        if not isinstance(error, Stopped):
            print_thread(failed)

    def of_other(failed: Any) -> None:
        error = failed.exc_value
        if error is not None:
            where = getattr(failed.object, "__qualname__", None) or type(failed.object).__name__
            say(error, f"Python drops what comes out of {where}")
        print_other(failed)

    threading.excepthook = of_thread
    sys.unraisablehook = of_other
