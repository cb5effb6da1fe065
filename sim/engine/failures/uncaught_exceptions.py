"""Reports exceptions that Python only prints, as those of threads and destructors, or keeps in a future."""

import sys
import threading
import traceback
from collections.abc import Callable
from concurrent.futures import Future
from inspect import CO_COROUTINE
from typing import Any

from sim.engine.failures.failure import place_of
from sim.interpreter.exception_text import error_line
from sim.probes.on_path.cbtui_probe.own_lines import raised_at
from sim.probes.own_code import is_own
from sim.trace.events import NoticeKind
from sim.trace.events.fields import SourcePlace

Tell = Callable[[str, str, SourcePlace, NoticeKind], None]


def report_uncaught(tell: Tell, path: str, folder: str) -> None:
    """Print the tracebacks of such exceptions, and pass one sentence for each source line to ``tell``.

    It also gets the exception if that ended a thread, a job of a pool or a coroutine of a loop, else "", its
    line, and which it was. ``path`` is the program's file; files in ``folder`` also count as the learner's
    own. Exceptions from outside these files are only printed.
    """
    told: set[str] = set()

    def say(error: BaseException, what_follows: str, kind: NoticeKind = NoticeKind.OTHER) -> None:
        place = place_of(error, path, folder)
        if place and place not in told:
            told.add(place)
            line = error_line(error)
            tell(
                f"{place}: {line}; {what_follows}",
                line * (kind is not NoticeKind.OTHER),
                raised_at(error, is_own),
                kind,
            )

    def of_thread(failed: threading.ExceptHookArgs) -> None:
        error = failed.exc_value
        if isinstance(error, SystemExit | None):
            return
        name = "a thread" if failed.thread is None else failed.thread.name
        if not isinstance(error, KeyboardInterrupt):
            say(error, f"{name} ended by it, and the rest goes on", NoticeKind.THREAD_DIED)
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

    def of_job(future: Any) -> None:
        error = vars(future).get("_unheard")
        if isinstance(error, Exception):
            whose, kind = _origin(error)
            say(error, f"nobody asks {whose} future for its result, so Python says nothing", kind)

    kind: Any = Future
    kind._exception, kind.__del__ = _KeptException(), of_job
    threading.excepthook = of_thread
    sys.unraisablehook = of_other


def _origin(error: BaseException) -> tuple[str, NoticeKind]:
    """Return whose future keeps an exception, as a possessive, by the outermost frame that it left."""
    trace = error.__traceback__
    frame = None if trace is None else trace.tb_frame
    if frame is not None and frame.f_code.co_flags & CO_COROUTINE:
        return "the coroutine's", NoticeKind.COROUTINE_DIED
    if frame is not None and frame.f_globals.get("__name__", "").startswith("concurrent."):
        return "the pool's", NoticeKind.JOB_DIED
    return "the", NoticeKind.OTHER


class _KeptException:
    """The exception in a future of another thread, which is unheard until somebody asks for it.

    That is an attribute of Python's own; functions around ``result()`` would stand in every traceback.
    """

    def __get__(self, future: object, _owner: type) -> BaseException | None:
        if future is None:  # asked of the class, as inspect.getmembers() does
            return None
        vars(future).pop("_unheard", None)
        return vars(future)["_exception"]  # type: ignore[no-any-return]

    def __set__(self, future: object, error: BaseException | None) -> None:
        vars(future).update(_exception=error, _unheard=error)


def _source(failed: Any) -> tuple[str, str | None]:
    """Return the function or object that an exception came from, and Python's heading for it.

    From 3.13 on Python may pass a heading alone; it has an address in it, and so differs from run to run.
    """
    if failed.object is None and failed.exc_traceback is not None:
        return failed.exc_traceback.tb_frame.f_code.co_qualname, None
    return getattr(failed.object, "__qualname__", None) or type(failed.object).__name__, failed.err_msg
