"""Describes in one sentence how a program failed: the learner's file and line, the error, what to do."""

import traceback
from dataclasses import dataclass
from pathlib import Path
from types import FrameType

from sim.engine.failures.advice import advice_on
from sim.engine.failures.missing_names import names_for_programs
from sim.interpreter.exception_text import error_text
from sim.probes.on_path.cbtui_probe.own_lines import culprit_of
from sim.probes.own_code import is_own

_MODEL = Path(__file__).parents[2]


@dataclass(frozen=True, slots=True)
class Failure:
    """How a program failed: the learner's file and line (0: none), what happened there, and what to do.

    ``exception`` is the exception's class.
    """

    file: str
    line: int
    what: str
    advice: str = ""
    exception: str = ""

    @property
    def sentence(self) -> str:
        """The failure as one sentence."""
        advice = f"; {self.advice}" if self.advice else ""
        return f"{_place(self.file, self.line)}: {self.what}{advice}"


def failure(error: BaseException, path: str, folder: str) -> Failure:
    """Describe an exception that a program did not catch.

    ``path`` is the program's file; files in ``folder`` also count as the learner's own.
    """
    exception, text = type(error).__name__, _text(error)
    if isinstance(error, SyntaxError) and error.filename and _is_own(error.filename, path, folder):
        return Failure(error.filename, error.lineno or 0, str(error.msg), exception=exception)
    what = f"the program raised {exception}{f': {text}' if text else ''}"
    culprit = culprit_of(error, is_own)
    if culprit is not None and _is_own(culprit[0], path, folder):
        file, line, advice = culprit
        return Failure(file, line, what, advice, exception)
    found = _innermost(error, path, folder)
    if found is None:
        return Failure(path, 0, what, advice_on(error, None), exception)
    return Failure(found[0].f_code.co_filename, found[1], what, advice_on(error, found[0]), exception)


def breakdown(error: Exception) -> str:
    """Return a sentence on an exception of the engine itself, outside all programs."""
    frames = traceback.extract_tb(error.__traceback__)
    place = f" ({_place(frames[-1].filename, frames[-1].lineno or 0)})" if frames else ""
    return f"the engine failed: {type(error).__name__}: {error_text(error)}{place}; cbtui doctor may tell why"


def place_of(error: BaseException, path: str, folder: str) -> str:
    """Return where in the learner's own files an exception was raised, as "file:line"; "" for nowhere."""
    found = _innermost(error, path, folder)
    return "" if found is None else _place(found[0].f_code.co_filename, found[1])


def _text(error: BaseException) -> str:
    """Return an exception's text, with module names as the learner knows them."""
    text = error_text(error)
    if isinstance(error, ImportError):
        text = text.partition(" (")[0]
    return names_for_programs(text) if isinstance(error, ImportError | AttributeError) else text


def _innermost(error: BaseException, path: str, folder: str) -> tuple[FrameType, int] | None:
    found = None
    for frame, line in traceback.walk_tb(error.__traceback__):
        if _is_own(frame.f_code.co_filename, path, folder):
            found = frame, line
    return found


def _is_own(file: str, path: str, folder: str) -> bool:
    return file == path or is_learners(file, folder)


def is_learners(file: str, folder: str | Path) -> bool:
    """Return whether a file is below ``folder``, and neither installed nor part of the model."""
    where = Path(file)
    within = where.is_relative_to(folder) and not where.is_relative_to(_MODEL)
    return within and "site-packages" not in where.parts


def _place(file: str, line: int) -> str:
    name = Path(file).name
    return f"{name}:{line}" if line else name
