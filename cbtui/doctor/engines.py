"""Examines whether an engine runs."""

import time

from cbtui.doctor.examination import Examination, fault, note, well
from cbtui.engines.follow import EngineLostError, FollowedRun, RunTimeoutError
from cbtui.engines.session import ProcessSession
from cbtui.runs.setup.lesson_setup import RunRequest
from lessons.catalogue import find
from sim.engine.setup import RunSetup
from sim.trace.events import RunEnded

_LESSON = "single-thread"
_RUN = 0.1
"""Seconds that the run lasts in its own time."""
_TIMEOUT = 60.0
"""Seconds without events after which the engine has failed."""
_SLOW = 3.0
"""Seconds from which on the engine's start is reported as slow."""
_REMEDY = "run cbtui run single-thread --for 1 to see more, and reinstall cbtui if it says nothing"


def engine() -> Examination:
    """Run a lesson for a tenth of a second of its own time, without the robot."""
    try:
        setup = RunRequest(lesson=find(_LESSON), robot=False, seconds=_RUN).setup()
    except ValueError:
        return note("engine", "was not tried", "fix the lessons first")
    began = time.monotonic()
    try:
        trouble = _trouble(setup)
    except OSError as error:
        trouble = error.strerror or str(error)
    took = time.monotonic() - began
    if trouble is not None:
        return fault("engine", f"does not run ({trouble})", _REMEDY)
    if took > _SLOW:
        return note("engine", f"runs, after {took:.1f} s", "give the machine less to do besides")
    return well("engine", f"started, ran for {_RUN:g} s of virtual time and ended in {took:.2f} s")


def _trouble(setup: RunSetup) -> str | None:
    reason: str | None = None
    with FollowedRun(setup, ProcessSession) as run:
        try:
            run.start()
            run.limit(_TIMEOUT)
            for batch in run:
                run.limit(_TIMEOUT)
                for event in batch:
                    if isinstance(event, RunEnded) and event.failed:
                        reason = event.reason
        except RunTimeoutError:
            return f"it gave no result within {_TIMEOUT:g} s"
        except EngineLostError as error:
            return str(error)
    return reason
