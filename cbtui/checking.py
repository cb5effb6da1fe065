"""Runs a lesson's node, or a learner's file in its place, on virtual time, so that checks can judge it.

Whatever the file does, it ends: a run has a limit of real time and one of what it may write.
"""

import time
from dataclasses import dataclass
from pathlib import Path
from queue import Empty, Full, Queue
from threading import Event
from typing import TypeAlias

import msgspec

from cbtui.lesson_setup import setup_for
from cbtui.session import Session
from lessons.judge import Judge, Judged
from lessons.lesson import Lesson
from sim.engine.setup import ProgramSetup, RunSetup, TimedCall, TimedLine
from sim.trace.events import AnyEvent, Logged, Printed
from sim.trace.model import Nanoseconds
from sim.trace.timeline import Timeline

LIMIT = 60.0
"""Real seconds that a run may take; those of the lessons take one."""
MOST_TEXT = 32_000_000
"""Characters that a run may write to its log and its output."""
_SECOND: Nanoseconds = 1_000_000_000
_BATCHES = 64
_LOOK = 0.1

_News: TypeAlias = "list[AnyEvent] | str | None"


@dataclass(frozen=True)
class Observed:
    """A run that is over, and in a sentence why it came to no good end; None if it did.

    ``broken_off`` tells that it was cut short from outside or died, and did not fail by itself.
    """

    timeline: Timeline
    trouble: str | None = None
    broken_off: bool = False


@dataclass(frozen=True)
class Checked:
    """What came of a learner's file: each check, or none and the sentence of what is wrong with the file."""

    judged: tuple[Judged, ...]
    total: int
    run: Observed

    @property
    def passed(self) -> int:
        """How many checks passed."""
        return sum(each.verdict.passed for each in self.judged)

    @property
    def good(self) -> bool:
        """Whether the file does all that the exercise asks."""
        return self.run.trouble is None and self.passed == self.total


def setup_to_judge(lesson: Lesson, file: Path | None = None) -> RunSetup:
    """Return the run that the lesson's predictions and checks are about, of its node or of another file."""
    terms = lesson.run
    setup = setup_for(lesson, threads=terms.threads if file is None else None, speed=None)
    if file is not None:
        program = ProgramSetup(str(file.resolve()), tuple(lesson.setup.arguments))
        setup = msgspec.structs.replace(setup, programs=(program,))
    return msgspec.structs.replace(
        setup,
        until=_ns(terms.seconds),
        calls=tuple(TimedCall(_ns(at), data=True) for at in sorted(terms.calls)),
        lines=tuple(TimedLine(_ns(at), text) for at, text in sorted(terms.lines)),
    )


def check(lesson: Lesson, judge: Judge, file: Path, limit: float = LIMIT) -> Checked:
    """Run a learner's file and judge it by a lesson's checks; takes about a second, at most ``limit``."""
    run = observe(setup_to_judge(lesson, file), file.name, limit)
    judged = () if run.trouble is not None else tuple(judge.verdicts(run.timeline))
    return Checked(judged, len(judge.checks), run)


def observe(setup: RunSetup, name: str, limit: float = LIMIT) -> Observed:
    """Run what is set up to its end, on the caller's thread; ``name`` is what it is called in sentences."""
    news: Queue[_News] = Queue(_BATCHES)
    over = Event()

    def put(item: _News) -> None:
        while not over.is_set():
            try:
                news.put(item, timeout=_LOOK)
            except Full:
                continue
            break

    session = Session(setup, put, put)
    session.start()
    try:
        return _followed(news, name, limit)
    finally:
        over.set()
        session.stop()


def _followed(news: "Queue[_News]", name: str, limit: float) -> Observed:
    timeline = Timeline()
    give_up = time.monotonic() + limit
    text = 0
    while (left := give_up - time.monotonic()) > 0:
        try:
            batch = news.get(timeout=left)
        except Empty:
            break
        if batch is None:
            return _ended(timeline, name)
        if isinstance(batch, str):
            sentence = f"{name} ended its whole process at {_time(timeline)}: {batch}"
            return Observed(timeline, sentence, broken_off=True)
        timeline.extend(batch)
        text += sum(len(event.text) for event in batch if isinstance(event, Logged | Printed))
        if text > MOST_TEXT:
            sentence = f"{name} wrote more than {MOST_TEXT // 1_000_000} MB of log by {_time(timeline)}"
            return Observed(timeline, sentence, broken_off=True)
    sentence = f"{name} was given {limit:g} s of real time, and had not come further than {_time(timeline)}"
    return Observed(timeline, sentence, broken_off=True)


def _ended(timeline: Timeline, name: str) -> Observed:
    ended = timeline.ended
    if ended is None or not ended.failed:
        return Observed(timeline)
    reason = " ".join(ended.reason.split())
    return Observed(timeline, reason if name in reason else f"{name}: {reason}")


def _time(timeline: Timeline) -> str:
    return f"{timeline.end / _SECOND:.3f} s"


def _ns(seconds: float) -> Nanoseconds:
    return round(seconds * _SECOND)
