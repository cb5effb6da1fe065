"""Tells in one sentence how a program failed: the learner's own file and line, what came up, what to do."""

import traceback
from pathlib import Path
from types import FrameType

from sim.engine.failures.advice import advice_on
from sim.error_text import error_text

_MODEL = Path(__file__).parents[2]


def failure(error: BaseException, path: str, folder: str) -> str:
    """The sentence for an exception that a program did not catch.

    ``path`` is the program's file; files in ``folder`` count as the learner's own too.
    """
    if isinstance(error, SyntaxError) and error.filename and _is_own(error.filename, path, folder):
        return f"{_place(error.filename, error.lineno or 0)}: {error.msg}"
    found = _innermost(error, path, folder)
    place = Path(path).name if found is None else _place(found[0].f_code.co_filename, found[1])
    frame = None if found is None else found[0]
    text = _text(error)
    what = f"{type(error).__name__}: {text}" if text else type(error).__name__
    return f"{place}: the program raised {what}{advice_on(error, frame)}"


def breakdown(error: Exception) -> str:
    """The sentence for an exception of the engine's own, outside all programs."""
    frames = traceback.extract_tb(error.__traceback__)
    place = f" ({_place(frames[-1].filename, frames[-1].lineno or 0)})" if frames else ""
    return f"the engine failed: {type(error).__name__}: {error_text(error)}{place}; cbtui doctor may tell why"


def place_of(error: BaseException, path: str, folder: str) -> str:
    """Where in the learner's own files an exception came up, as " (file:line)"; empty where it did not."""
    found = _innermost(error, path, folder)
    return "" if found is None else f" ({_place(found[0].f_code.co_filename, found[1])})"


def _text(error: BaseException) -> str:
    """An exception's text, the names of modules as the learner knows them."""
    text = error_text(error)
    if isinstance(error, ImportError):
        text = text.partition(" (")[0].replace("'sim.ros.rclpy", "'rclpy")
    return text


def _innermost(error: BaseException, path: str, folder: str) -> tuple[FrameType, int] | None:
    found = None
    for frame, line in traceback.walk_tb(error.__traceback__):
        if _is_own(frame.f_code.co_filename, path, folder):
            found = frame, line
    return found


def _is_own(file: str, path: str, folder: str) -> bool:
    return file == path or is_learners(file, folder)


def is_learners(file: str, folder: str | Path) -> bool:
    """Whether a file in ``folder`` or below is the learner's, and neither installed nor the model's."""
    where = Path(file)
    within = where.is_relative_to(folder) and not where.is_relative_to(_MODEL)
    return within and "site-packages" not in where.parts


def _place(file: str, line: int) -> str:
    name = Path(file).name
    return f"{name}:{line}" if line else name
