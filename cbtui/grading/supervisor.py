"""The process between the grader and a submission: it runs the copy, judges the trace and returns the marks.

A submission that kills its parent kills this process, which the grader notices.
"""

import multiprocessing
import os
import resource
import secrets
import signal
import sys
import tempfile
import threading
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from multiprocessing.connection import Connection
from pathlib import Path
from types import FrameType
from typing import Any, NoReturn

import msgspec

from cbtui.engines.forking import forking_context
from cbtui.engines.session import ProcessSession
from cbtui.grading.confinement import Confinement
from cbtui.grading.submission import Submission
from cbtui.grading.trace_audit import TraceAudit
from cbtui.runs.judged.check_text import verdict_line
from cbtui.runs.judged.checking import observe
from cbtui.runs.setup.lesson_setup import setup_to_judge
from lessons.judge import Judge
from lessons.lesson import Lesson, read_lesson
from sim.engine.setup import RealRos

_LARGEST_FILE = 1 << 28
"""The largest file in bytes that a program may write."""
_JUDGING_TIMEOUT = 30.0
"""Real seconds for judging, beyond the limit of the run."""
_EXIT_TIMEOUT = 2.0
_MOST_BYTES = 1 << 24
_PRELOADED = (__name__,)


class Marks(msgspec.Struct, frozen=True):
    """The marks of a submission: for each check whether it passed, and a line on it.

    Without checks, ``trouble`` says why nothing could be judged, or ``doubts`` are signs of a forgery.
    """

    checks: tuple[tuple[bool, str], ...] = ()
    trouble: str = ""
    doubts: tuple[str, ...] = ()


@dataclass(frozen=True)
class MarkingJob:
    """A submission to run and judge. ``limit`` is in real seconds; ``folder`` is for the copy."""

    submission: Submission
    lesson: Path
    limit: float
    folder: Path
    launcher: Path | None
    environment: Mapping[str, str]
    confinement: Confinement
    real: RealRos | None
    timeout: float
    """Real seconds until it must be judged."""


def mark(
    submission: Submission, lesson: Lesson, limit: float, confinement: Confinement, real: RealRos | None
) -> Marks:
    """Run a submission, with ``real`` on that ROS 2, and judge it by a lesson's checks.

    ``limit`` is that of ``real_limit``.
    """
    with tempfile.TemporaryDirectory(prefix="cbtui-grade-", ignore_cleanup_errors=True) as place:
        folder = Path(place).resolve() / "copy"
        folder.mkdir()
        return _marks_by_supervisor(
            MarkingJob(
                submission,
                lesson.folder,
                limit,
                folder,
                confinement.launcher(folder, folder.with_name("launcher")),
                confinement.environment(folder),
                confinement,
                real,
                limit + lesson.run.seconds + _JUDGING_TIMEOUT,
            )
        )


def _marks_by_supervisor(assignment: MarkingJob) -> Marks:
    context: Any = forking_context(_PRELOADED)
    ours, theirs = context.Pipe()
    process = context.Process(target=_supervise, args=(assignment, theirs), name="cbtui-supervisor")
    process.start()
    theirs.close()
    try:
        if not ours.poll(assignment.timeout):
            return Marks(trouble="what its run showed took too long to be judged")
        return msgspec.msgpack.decode(ours.recv_bytes(_MOST_BYTES), type=Marks)
    except (EOFError, OSError, msgspec.DecodeError):
        return Marks(doubts=("it ended or disturbed the process that graded it",))
    finally:
        process.terminate()
        process.join(_EXIT_TIMEOUT)
        process.kill()
        process.join()
        ours.close()


def _supervise(assignment: MarkingJob, grader: Connection) -> None:
    """Run the supervisor in a session of its own, without the terminal."""
    os.setsid()
    signal.signal(signal.SIGTERM, _leave)
    threading.Thread(target=_end_with_grader, name="grader-watch", daemon=True).start()
    nothing = os.open(os.devnull, os.O_RDWR)
    for number in range(3):
        os.dup2(nothing, number)
    os.environ.clear()
    os.environ.update(assignment.environment)
    sys.path[:] = assignment.confinement.import_path
    sys.dont_write_bytecode = True
    os.chdir(assignment.folder)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_FSIZE, (_LARGEST_FILE, _LARGEST_FILE))
    if assignment.launcher is not None:
        multiprocessing.set_executable(str(assignment.launcher))
    grader.send_bytes(msgspec.msgpack.encode(_marks(assignment)))


def _marks(assignment: MarkingJob) -> Marks:
    submission, lesson = assignment.submission, read_lesson(assignment.lesson)
    judge = Judge(lesson)
    program = submission.write_to(assignment.folder)
    key = secrets.token_bytes(32)
    setup = setup_to_judge(lesson, program, real=assignment.real)
    setup = msgspec.structs.replace(setup, packages=(), seal=key)
    libraries = assignment.confinement.libraries
    audit = TraceAudit(key, submission, assignment.folder, libraries, virtual=setup.clock == "virtual")
    run = observe(
        setup, program.name, assignment.limit, open_session=partial(ProcessSession, unpack=audit.unpack)
    )
    doubts = audit.doubts(ended_normally=run.trouble is None)
    if doubts or run.trouble is not None:
        return Marks(trouble=run.trouble or "", doubts=doubts)
    judged = judge.verdicts(run.timeline)
    return Marks(tuple((each.verdict.passed, f"{each.check.asks}; {verdict_line(each)}") for each in judged))


def _leave(_number: int, _frame: FrameType | None) -> NoReturn:
    sys.exit(1)


def _end_with_grader() -> None:
    """Exit when the grader is killed."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
    os.kill(os.getpid(), signal.SIGTERM)
