"""From a lesson, or a learner's own file, to the set-up of a run of it."""

from collections.abc import Sequence
from pathlib import Path

import msgspec

from lessons.catalogue import ROOT
from lessons.lesson import Lesson
from sim.engine.setup import Keyboard, ProgramSetup, RobotUse, RunSetup, ServiceChoice, TimedCall, TimedLine
from sim.units import nearest_ns

_LESSON_PACKAGES = tuple(str(path) for path in sorted(ROOT.glob("unit*")))
"""Folders in which the packages of the lessons lie."""


def setup_for(lesson: Lesson, *, threads: int | None = None, speed: float | None = 1.0) -> RunSetup:
    """Return what an engine needs to run a lesson, on the clock that it names.

    ``threads`` None leaves the lesson's own number; ``speed`` is seconds of the run per real second, None for
    as fast as it can: on the real clock that is 1. There the robot is only made for a lesson that uses it, as
    its physics would compute beside the node.
    """
    clock = lesson.setup.clock
    return RunSetup(
        title=lesson.id,
        programs=(ProgramSetup(str(lesson.node_path), tuple(lesson.arguments_with(threads))),),
        service=ServiceChoice(lesson.service.name, lesson.service.type),
        clock=clock,
        packages=_LESSON_PACKAGES,
        robot=RobotUse.ALWAYS if clock == "virtual" else RobotUse.WHEN_USED,
        speed=speed,
        threads=threads,
    )


def setup_for_files(
    paths: Sequence[Path],
    arguments: Sequence[str] = (),
    *,
    threads: int | None = None,
    speed: float | None = 1.0,
) -> RunSetup:
    """Return what an engine needs to run program files, on wall time as they would run elsewhere.

    Every file gets the same ``arguments``.
    """
    return RunSetup(
        title=" ".join(path.name for path in paths),
        programs=tuple(ProgramSetup(str(path.absolute()), tuple(arguments)) for path in paths),
        clock="real",
        packages=_LESSON_PACKAGES,
        robot=RobotUse.WHEN_USED,
        speed=speed,
        threads=threads,
    )


def setup_for_line(text: str, folder: Path) -> RunSetup:
    """Return what an engine needs to carry out a ``ros2`` line with nothing else running.

    Packages are looked for around ``folder`` and among the lessons.
    """
    return RunSetup(
        title=text,
        programs=(),
        clock="real",
        lines=(TimedLine(0, text),),
        keyboard=Keyboard.LIVE,
        packages=(str(folder), *_LESSON_PACKAGES),
        robot=RobotUse.WHEN_USED,
    )


def setup_to_judge(lesson: Lesson, file: Path | None = None) -> RunSetup:
    """Return the run that the lesson's predictions and checks are about, of its node or of another file."""
    terms = lesson.run
    setup = setup_for(lesson, threads=terms.threads if file is None else None, speed=None)
    if file is not None:
        program = ProgramSetup(str(file.absolute()), tuple(lesson.setup.arguments))
        setup = msgspec.structs.replace(setup, programs=(program,))
    return msgspec.structs.replace(
        setup,
        until=nearest_ns(terms.seconds),
        calls=tuple(TimedCall(nearest_ns(at), data=True) for at in sorted(terms.calls)),
        lines=tuple(TimedLine(nearest_ns(at), text) for at, text in sorted(terms.lines)),
    )
