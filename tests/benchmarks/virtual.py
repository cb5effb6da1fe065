"""How fast virtual time goes: a robot with its sensors and the trace, and all lessons one after the other."""

import time

from lessons.catalogue import lessons
from tests.support.engine_runs import run_lesson

_run_anew = run_lesson.__wrapped__
"""Not one that was kept from the measurement before."""

_ROBOTS = "shared-group"


def robot(seconds: int) -> float:
    """The real seconds that a second of a robot's lesson takes, its engine's start left out."""
    once = _took(_ROBOTS, 0.1)
    return (_took(_ROBOTS, float(seconds)) - once) / seconds


def all_lessons(seconds: int) -> float:
    """The real seconds that so many seconds of every lesson take, engines and all."""
    return sum(_took(lesson.id, float(seconds)) for lesson in lessons())


def _took(lesson: str, seconds: float) -> float:
    began = time.perf_counter()
    _run_anew(lesson, seconds)
    return time.perf_counter() - began
