"""Makes the set-up of a run from a request: a lesson, or a learner's own files."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from operator import itemgetter
from pathlib import Path

from cbtui.runs.setup.changes import Changes
from lessons.catalogue import ROOT
from lessons.lesson import Lesson
from sim.clock.schedule import Seed
from sim.engine.setup import (
    Keyboard,
    ProgramSetup,
    RealRos,
    RobotUse,
    RunSetup,
    ServiceChoice,
    TimedCall,
    TimedLine,
    TimedText,
)
from sim.quantities.nanoseconds import nearest_ns

_LESSON_PACKAGES = tuple(str(path) for path in sorted(ROOT.glob("unit*")))
"""Folders of the lessons' packages."""


@dataclass(frozen=True, kw_only=True)
class RunRequest:
    """A request for a run; ``setup()`` makes the engine's set-up.

    A ``lesson`` runs its own node, or one of ``files`` in its place; without a lesson the ``files`` run, with
    the ``arguments``: of several files the second gets those behind the first ``--``, and so on. Times are
    seconds of the run's own time. ``clock`` None is the lesson's, for files the real one. ``speed`` None:
    as fast as possible; else seconds of the run per real second, on the real clock 1.

    On a lesson's real clock the robot is only created when it is used: its physics computes beside the node.
    """

    lesson: Lesson | None = None
    files: Sequence[Path] = ()
    arguments: Sequence[str] = ()
    changes: Changes = field(default_factory=Changes)
    clock: str | None = None
    speed: float | None = None
    robot: bool = True
    seconds: float | None = None
    """The length of the run; None for no end."""
    calls: Iterable[float] = ()
    """When the lesson's SetBool service is called, with ``call_data``."""
    call_data: bool = True
    lines: Iterable[tuple[float, str]] = ()
    """``ros2`` lines, each with its time."""
    typed: Iterable[tuple[float, str]] = ()
    """Text for the programs' terminal, each with its time."""
    keyboard: Keyboard = Keyboard.NOBODY
    contents: bool = False

    @property
    def names_program(self) -> bool:
        """Whether there is a lesson or a file to run."""
        return self.lesson is not None or bool(self.files)

    def setup(self) -> RunSetup:
        """Return the set-up of the run, with the changes applied."""
        lesson = self.lesson
        setup = RunSetup(
            title=" ".join(path.name for path in self.files) if lesson is None else lesson.id,
            programs=tuple(self._programs()),
            service=None if lesson is None else ServiceChoice(lesson.service.name, lesson.service.type),
            clock=self.clock or ("real" if lesson is None else lesson.setup.clock),
            speed=self.speed,
            until=None if self.seconds is None else nearest_ns(self.seconds),
            calls=tuple(TimedCall(nearest_ns(at), self.call_data) for at in sorted(self.calls)),
            lines=tuple(TimedLine(nearest_ns(at), text) for at, text in _in_order(self.lines)),
            typed=tuple(TimedText(nearest_ns(at), text) for at, text in _in_order(self.typed)),
            keyboard=self.keyboard,
            packages=_LESSON_PACKAGES,
            robot=self._robot_use(),
            contents=self.contents,
            distro="" if lesson is None else lesson.setup.distro,
        )
        return self.changes.applied(setup)

    def _programs(self) -> Iterator[ProgramSetup]:
        lesson = self.lesson
        if lesson is not None and not self.files:
            arguments = lesson.arguments_with(self.changes.threads)
            yield ProgramSetup(str(lesson.node_path), tuple(arguments))
        left = self.arguments if lesson is None else lesson.setup.arguments
        for path in self.files:
            several = len(self.files) > 1 and "--" in left
            end = left.index("--") if several else len(left)
            yield ProgramSetup(str(path.absolute()), tuple(left[:end]))
            left = left[end + 1 :]

    def _robot_use(self) -> RobotUse:
        if not self.robot:
            return RobotUse.NEVER
        virtual = self.lesson is not None and self.lesson.setup.clock == "virtual"
        return RobotUse.ALWAYS if virtual else RobotUse.WHEN_USED


def setup_for(lesson: Lesson, *, threads: int | None = None, speed: float | None = 1.0) -> RunSetup:
    """Return the set-up of a lesson's run; ``threads`` None keeps the lesson's own number."""
    return RunRequest(lesson=lesson, changes=Changes(threads), speed=speed).setup()


def setup_for_line(text: str, folder: Path) -> RunSetup:
    """Return the set-up of an engine that only carries out a ``ros2`` line.

    Packages are searched for around ``folder`` and among the lessons.
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


def request_to_judge(
    lesson: Lesson, file: Path | None = None, *, seed: Seed | None = None, real: RealRos | None = None
) -> RunRequest:
    """Return the run that the lesson's predictions and checks judge, of its node or of another file.

    ``seed`` chooses the thread schedule, None the default one; with ``real`` it runs on that ROS 2.
    """
    terms = lesson.run
    return RunRequest(
        lesson=lesson,
        files=() if file is None else (file,),
        changes=Changes(terms.threads if file is None else None, seed=seed, real=real),
        seconds=terms.seconds,
        calls=terms.calls,
        lines=sorted(terms.lines),
    )


def setup_to_judge(
    lesson: Lesson, file: Path | None = None, *, seed: Seed | None = None, real: RealRos | None = None
) -> RunSetup:
    """Return the set-up of ``request_to_judge``."""
    return request_to_judge(lesson, file, seed=seed, real=real).setup()


def _in_order(timed: Iterable[tuple[float, str]]) -> list[tuple[float, str]]:
    return sorted(timed, key=itemgetter(0))
