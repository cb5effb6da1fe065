"""The true answers to a lesson's predictions, found in the trace of a separate run."""

from collections.abc import Callable
from dataclasses import dataclass
from threading import Event
from typing import TYPE_CHECKING, TypeAlias

from lessons.lesson import BadLesson, Lesson
from sim.quantities.plural import counted

if TYPE_CHECKING:
    from cbtui.runs.judged.checking import ObservedRun
    from sim.engine.setup import RealRos, RunSetup

Observe: TypeAlias = Callable[["RunSetup", str, Event], "ObservedRun"]
"""Runs a set-up to its end on the caller's thread; the event aborts the run."""


@dataclass(frozen=True)
class PredictionOutcome:
    """The true answer to each prediction in order, or ``trouble``, a sentence on why there are none."""

    true: tuple[int, ...] = ()
    trouble: str | None = None
    is_real: bool = False
    """Whether they are those of a run on real ROS 2."""


class OutcomeRun:
    """The run that predictions are compared with.

    ``run`` blocks and needs a thread of its own; ``give_up`` may be called from any other. With ``real`` it
    runs on that ROS 2, in real time.
    """

    def __init__(self, lesson: Lesson, observe: Observe, real: "RealRos | None" = None) -> None:
        self._lesson = lesson
        self._observe = observe
        self._real = real
        self._given_up = Event()
        self._ended = Event()

    def give_up(self) -> None:
        """Make ``run`` end its engine and return. Idempotent."""
        self._given_up.set()

    def wait(self, seconds: float) -> None:
        """Wait for the engine's end, at most a number of real seconds."""
        self._ended.wait(seconds)

    def run(self) -> PredictionOutcome:
        """Run the lesson and return the true answers; the engine has ended when this returns."""
        try:
            return self._outcome()
        except BadLesson as error:
            excuse = "" if self._real is None else self._lesson.setup.not_on_ros2
            return PredictionOutcome(trouble=excuse or str(error))
        except OSError as error:
            return PredictionOutcome(trouble=f"the engine could not be started: {error.strerror or error}")
        finally:
            self._ended.set()

    def _outcome(self) -> PredictionOutcome:
        # imported on this thread, as the screen must not wait for it
        from cbtui.runs.setup.lesson_setup import setup_to_judge
        from lessons.judge import Judge

        judge = Judge(self._lesson)
        setup = setup_to_judge(self._lesson, real=self._real)
        observed = self._observe(setup, self._lesson.node_path.name, self._given_up)
        if observed.broken_off:
            return PredictionOutcome(trouble=observed.trouble)
        return PredictionOutcome(
            tuple(judge.true_answer(each, observed.timeline) for each in self._lesson.predictions),
            is_real=self._real is not None,
        )


def observe_engine(setup: "RunSetup", name: str, given_up: Event) -> "ObservedRun":
    """Run a set-up in a separate engine."""
    from cbtui.runs.judged.checking import observe

    return observe(setup, name, given_up=given_up)


def run_text(lesson: Lesson) -> str:
    """Describe the run that a lesson's predictions are compared with."""
    run = lesson.run
    parts = [f"a run of {run.seconds:g} s"]
    if run.threads is not None:
        parts.append(counted(run.threads, "thread"))
    if run.calls:
        parts.append(f"{lesson.service.name} called at {_listed([f'{at:g}' for at in run.calls])} s")
    parts += [f"`{line}` given at {at:g} s" for at, line in run.lines]
    first, *others = parts
    return f"{first} with {_listed(others)}" if others else first


def _listed(words: list[str]) -> str:
    """``a``, ``a and b``, ``a, b and c``."""
    *most, last = words
    return f"{', '.join(most)} and {last}" if most else last
