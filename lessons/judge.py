"""Judges runs by a lesson's `checks.py`: which answers are true, and which checks pass."""

import importlib.util
import sys
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

from lessons.checks import Check, Verdict
from lessons.description import Prediction
from lessons.lesson import BadLesson, Lesson
from sim.trace.timeline import Timeline

_CHECKS = "CHECKS"
"""The name of the tuple of checks in a `checks.py`."""


@dataclass(frozen=True, slots=True)
class JudgedCheck:
    """A check and its verdict."""

    check: Check
    verdict: Verdict


class Judge:
    """The checks of a lesson, and the functions that find the true answers in a run."""

    def __init__(self, lesson: Lesson) -> None:
        """Read the lesson's `checks.py`.

        Raises:
            BadLesson: it cannot be imported, or lacks what the lesson's predictions and exercise need.
        """
        self._path = lesson.checks_path
        module = _imported(self._path) if self._path.is_file() else ModuleType("nothing")
        self.checks = self._checks_in(module)
        self._shown = {each.shown: self._function(module, each.shown) for each in lesson.predictions}
        if lesson.exercise is not None and not self.checks:
            raise BadLesson(f"{self._path}: the exercise needs a tuple {_CHECKS} with at least one check")

    def verdicts(self, run: Timeline) -> list[JudgedCheck]:
        """Judge a finished run by every check, in their order."""
        return [self.judge(check, run) for check in self.checks]

    def judge(self, check: Check, run: Timeline) -> JudgedCheck:
        """Judge a finished run by one of the checks; a check that raises has failed."""
        return JudgedCheck(check, _verdict(check, run))

    def true_answer(self, prediction: Prediction, run: Timeline) -> int:
        """Return which answer of a prediction a run shows to be true, from 0.

        Raises:
            BadLesson: the lesson's function fails, or returns no answer's number.
        """
        try:
            answer = self._shown[prediction.shown](run)
        except Exception as error:
            where = _place(self._path, error)
            raise BadLesson(f"{where}: {prediction.shown} raised {_named(error)}") from error
        if type(answer) is not int or not 0 <= answer < len(prediction.answers):
            numbers = f"0 to {len(prediction.answers) - 1}"
            raise BadLesson(f"{self._path}: {prediction.shown} returned {answer!r}; an answer is {numbers}")
        return answer

    def _checks_in(self, module: ModuleType) -> tuple[Check, ...]:
        checks = getattr(module, _CHECKS, ())
        if not isinstance(checks, tuple) or not all(isinstance(each, Check) for each in checks):
            raise BadLesson(f"{self._path}: {_CHECKS} is not a tuple of checks")
        return checks

    def _function(self, module: ModuleType, name: str) -> Callable[[Timeline], object]:
        function = getattr(module, name, None)
        if not callable(function):
            raise BadLesson(f"{self._path}: there is no function {name}, which a prediction names")
        return function  # type: ignore[no-any-return]  # what it returns is looked at


def _verdict(check: Check, run: Timeline) -> Verdict:
    try:
        return check.judge(run)
    except Exception as error:  # noqa: BLE001 - a check that stumbles over a learner's run has not passed
        return Verdict(False, "a run that this check can read", f"an error in the check: {_named(error)}")


def _named(error: Exception) -> str:
    message = error.msg if isinstance(error, SyntaxError) else str(error)
    return f"{type(error).__name__}: {' '.join(message.split())}"


def _place(path: Path, error: Exception) -> str:
    """Return the file, with the line of it at which the error came up if that is known."""
    if isinstance(error, SyntaxError) and error.filename == str(path):
        return f"{path}:{error.lineno}"
    frames = traceback.extract_tb(error.__traceback__)
    lines = [frame.lineno for frame in frames if frame.filename == str(path)]
    return f"{path}:{lines[-1]}" if lines else str(path)


def _imported(path: Path) -> ModuleType:
    """Run a `checks.py` as a module that nobody can import, as every lesson has one of that name."""
    name = f"checks of {path.parent.name}"
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None, "a path that ends in .py has a loader"
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # dataclasses look up their module
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        raise BadLesson(f"{_place(path, error)}: cannot be imported: {_named(error)}") from error
    finally:
        del sys.modules[name]
    return module
