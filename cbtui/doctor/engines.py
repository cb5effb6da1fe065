"""Runs an engine for a moment, as every lesson does."""

import time
from queue import Empty, Queue

import msgspec

from cbtui.doctor.verdict import Verdict, fault, note, well
from cbtui.engines.session import Session
from cbtui.runs.setup.lesson_setup import setup_for
from lessons.catalogue import find
from sim.engine.setup import RobotUse, RunSetup
from sim.trace.events import AnyEvent, RunEnded

_LESSON = "single-thread"
_RUN = 100_000_000
"""Nanoseconds that the run lasts in its own time."""
_PATIENCE = 20.0
"""Seconds after which the engine is given up."""
_SLOW = 3.0
"""Seconds after which a learner wonders whether something is wrong."""
_REMEDY = "run cbtui run single-thread --for 1 to see more, and install cbtui anew if it says nothing"


def engine() -> Verdict:
    """Run a lesson for a tenth of a second of its own time, without the robot, in an engine of its own."""
    try:
        setup = setup_for(find(_LESSON), speed=None)
    except ValueError:
        return note("engine", "was not tried", "mend the lessons first")
    began = time.monotonic()
    try:
        trouble = _trouble(msgspec.structs.replace(setup, robot=RobotUse.NEVER, until=_RUN))
    except OSError as error:
        trouble = error.strerror or str(error)
    took = time.monotonic() - began
    if trouble is not None:
        return fault("engine", f"does not run ({trouble})", _REMEDY)
    if took > _SLOW:
        return note("engine", f"runs, after {took:.1f} s", "leave the machine more to itself")
    return well("engine", f"started, ran for {_RUN / 1e9:g} s of virtual time and ended in {took:.2f} s")


def _trouble(setup: RunSetup) -> str | None:
    news: Queue[list[AnyEvent] | str | None] = Queue()
    session = Session(setup, news.put, news.put)
    session.start()
    try:
        return _end_of(news)
    except Empty:
        return f"nothing came of it within {_PATIENCE:g} s"
    finally:
        session.stop()


def _end_of(news: "Queue[list[AnyEvent] | str | None]") -> str | None:
    reason: str | None = None
    while isinstance(batch := news.get(timeout=_PATIENCE), list):
        for event in batch:
            if isinstance(event, RunEnded) and event.failed:
                reason = event.reason
    return batch if batch is not None else reason
