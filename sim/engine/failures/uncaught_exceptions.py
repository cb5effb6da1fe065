"""Reports exceptions that Python itself only prints: those of threads, destructors and exit handlers."""

import sys
import threading
import traceback
from collections.abc import Callable
from typing import Any

from sim.engine.failures.failure import place_of
from sim.interpreter.exception_text import error_line
from sim.probes.own_code import raised_at
from sim.trace.events.fields import SourcePlace

Tell = Callable[[str, str, SourcePlace], None]


def report_uncaught(tell: Tell, path: str, folder: str) -> None:
    """Print the tracebacks of such exceptions, and pass one sentence for each source line to ``tell``.

    It also gets the exception if that ended a thread, else "", and its line. ``path`` is the program's file;
    files in ``folder`` also count as the learner's own. Exceptions from outside these files are only printed.
    """
    told: set[str] = set()

    def say(error: BaseException, what_follows: str, thread_died: str = "") -> None:
        place = place_of(error, path, folder)
        if place and place not in told:
            told.add(place)
            tell(f"{place}: {error_line(error)}; {what_follows}", thread_died, raised_at(error))

    def of_thread(failed: threading.ExceptHookArgs) -> None:
        error = failed.exc_value
        if isinstance(error, SystemExit | None):
            return
        name = "a thread" if failed.thread is None else failed.thread.name
        if not isinstance(error, KeyboardInterrupt):
            say(error, f"{name} ended by it, and the rest goes on", error_line(error))
        sys.stderr.write(f"Exception in thread {name}:\n")
        traceback.print_exception(error)

    def of_other(failed: Any) -> None:
        error = failed.exc_value
        if error is None:
            return
        where, heading = _source(failed)
        say(error, f"Python drops what comes out of {where}")
        sys.stderr.write(f"{heading or 'Exception ignored in'}: {where}\n")
        traceback.print_exception(error)

    threading.excepthook = of_thread
    sys.unraisablehook = of_other


def _source(failed: Any) -> tuple[str, str | None]:
    """Return the function or object that an exception came from, and Python's heading for it.

    From 3.13 on Python may pass a heading alone; it has an address in it, and so differs from run to run.
    """
    if failed.object is None and failed.exc_traceback is not None:
        return failed.exc_traceback.tb_frame.f_code.co_qualname, None
    return getattr(failed.object, "__qualname__", None) or type(failed.object).__name__, failed.err_msg
