"""Runs a lesson's node, or a learner's file in its place, on the lesson's clock, so that checks can judge it.

A run is limited in real time and in the amount of text that it writes.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from threading import Event

from cbtui.engines.follow import EngineLostError, FollowedRun, GivenUpError, RunTimeoutError
from cbtui.engines.session import OpenSession, ProcessSession
from cbtui.runs.setup.lesson_setup import setup_to_judge
from lessons.judge import Judge, JudgedCheck
from lessons.lesson import Lesson
from sim.clock.schedule import Seed
from sim.engine.setup import RealRos, RunSetup
from sim.quantities.durations import timestamp
from sim.quantities.nanoseconds import SECOND
from sim.trace.events import AnyEvent, Logged, Printed
from sim.trace.timeline import Timeline

LIMIT = 60.0
"""Default limit in real seconds; the lessons' own runs take one on virtual time."""
MOST_TEXT = 32_000_000
"""Limit of a run's log and output in characters."""


@dataclass(frozen=True)
class ObservedRun:
    """A finished run; ``trouble`` says in a sentence why it failed, None if it did not.

    ``broken_off`` tells that it was aborted or its engine was lost, rather than that its program failed.
    """

    timeline: Timeline
    trouble: str | None = None
    broken_off: bool = False


@dataclass(frozen=True)
class CheckedFile:
    """The results of a learner's file: its judged checks, none of them if the run failed."""

    judged: tuple[JudgedCheck, ...]
    total: int
    run: ObservedRun

    @property
    def passed(self) -> int:
        """How many checks passed."""
        return sum(each.verdict.passed for each in self.judged)

    @property
    def good(self) -> bool:
        """Whether the run succeeded and all checks passed."""
        return self.run.trouble is None and self.passed == self.total


def real_limit(setup: RunSetup, limit: float) -> float:
    """The real seconds that a run may take: on the real clock ``limit`` beyond its own length."""
    return limit if setup.clock == "virtual" else limit + (setup.until or 0) / SECOND


def check(
    lesson: Lesson,
    judge: Judge,
    file: Path,
    limit: float = LIMIT,
    *,
    seed: Seed | None = None,
    real: RealRos | None = None,
    take: Callable[[list[AnyEvent]], object] = len,
) -> CheckedFile:
    """Run a learner's file and judge it by a lesson's checks; takes about a second on virtual time.

    ``limit`` is that of ``real_limit``; ``seed`` and ``real`` are those of ``request_to_judge``; ``take``
    gets every batch of events.
    """
    run = observe(setup_to_judge(lesson, file, seed=seed, real=real), file.name, limit, take=take)
    judged = () if run.trouble is not None else tuple(judge.verdicts(run.timeline))
    return CheckedFile(judged, len(judge.checks), run)


def observe(
    setup: RunSetup,
    name: str,
    limit: float = LIMIT,
    given_up: Event | None = None,
    open_session: OpenSession = ProcessSession,
    take: Callable[[list[AnyEvent]], object] = len,
) -> ObservedRun:
    """Run a set-up to its end on the caller's thread; ``name`` stands for the program in sentences.

    ``limit`` is that of ``real_limit``. Setting ``given_up``, from any thread, aborts the run.
    ``open_session`` creates the session. ``take`` gets every batch of events.
    """
    timeline = Timeline(until_ending=True)
    text, limit = 0, real_limit(setup, limit)
    with FollowedRun(setup, open_session, given_up) as run:
        try:
            run.start()
            run.limit(limit)
            for batch in run:
                take(batch)
                timeline.extend(batch)
                text += text_in(batch)
                if text > MOST_TEXT:
                    return ObservedRun(timeline, wrote_too_much(timeline, name), broken_off=True)
        except GivenUpError:
            return ObservedRun(timeline, f"{name} was stopped at {_time(timeline)}", broken_off=True)
        except RunTimeoutError:
            return ObservedRun(timeline, took_too_long(timeline, name, limit), broken_off=True)
        except EngineLostError as error:
            return ended_run(timeline, name, str(error))
    return ended_run(timeline, name, None)


def ended_run(timeline: Timeline, name: str, loss: str | None) -> ObservedRun:
    """Return a run that has ended; ``loss`` says how its engine was lost, None if it was not."""
    if loss is not None:
        sentence = f"{name} ended its whole process at {_time(timeline)}: {loss}"
        return ObservedRun(timeline, sentence, broken_off=True)
    ended = timeline.ended
    if ended is None or not ended.failed:
        return ObservedRun(timeline)
    reason = " ".join(ended.reason.split())
    return ObservedRun(timeline, reason if name in reason else f"{name}: {reason}")


def text_in(events: Iterable[AnyEvent]) -> int:
    """Return the number of characters of log and output in some events."""
    return sum(len(event.text) for event in events if isinstance(event, Logged | Printed))


def wrote_too_much(timeline: Timeline, name: str) -> str:
    """Return the sentence on a run that was aborted for its amount of output."""
    return f"{name} wrote more than {MOST_TEXT // 1_000_000} MB of log by {_time(timeline)}"


def took_too_long(timeline: Timeline, name: str, limit: float) -> str:
    """Return the sentence on a run that was aborted for its real time."""
    return f"{name} was given {limit:g} s of real time, and had not come further than {_time(timeline)}"


def _time(timeline: Timeline) -> str:
    return f"{timestamp(timeline.end)}"
