"""What a lesson screen runs and shows: a lesson of the catalogue, or a file of the learner's own."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TypeAlias

from cbtui.runs.setup.changes import Changes
from cbtui.runs.setup.lesson_setup import RunRequest, request_to_judge, setup_for
from lessons.lesson import Lesson
from sim.engine.setup import RunSetup

SetUp: TypeAlias = Callable[[int | None, float | None], RunSetup]
"""Makes a run from a number of threads (None: the program's own) and a speed (None: as fast as it can)."""

_GUIDE = """# {name}

Your own file, on {clock} time. Every thread that runs callbacks has a lane; below are the callback groups, in
the order in which the program fills them, with what waits in them and why.

- `s` calls the first SetBool service that your program offers, `S` the same with false.
- `t` runs it again with another number of threads, `g` with another group for the selected callback, `p` with
  other timers' periods, and tells which line of code would do that.
- `r` puts the robot back to its start, and runs the file again when it is over.

The lessons' robot is there for your file too: `/odom`, `/scan`, `/cmd_vel`, `/reset_world`, `/motor_power`.
"""


@dataclass(frozen=True)
class ShownProgram:
    """One program to run on screen; ``service`` is empty where it shows only when the program runs.

    ``source`` is the program's text where it is not the one that lies at ``node_path`` now, ``sources`` the
    texts that a recording holds, by path.
    """

    heading: str
    guide: str
    node_path: Path
    service: str
    executor: str
    set_up: SetUp
    lesson: Lesson | None = None
    following: Lesson | None = None
    source: str | None = None
    sources: Mapping[str, str] = field(default_factory=dict)


def of_lesson(lesson: Lesson, lessons: Sequence[Lesson]) -> ShownProgram:
    """Return a lesson as a subject, among the ``lessons`` in their order."""
    place = lessons.index(lesson)
    unit = [each for each in lessons if each.unit == lesson.unit]
    return ShownProgram(
        heading=f"{unit.index(lesson) + 1}/{len(unit)} {lesson.title}",
        guide=lesson.guide,
        node_path=lesson.node_path,
        service=lesson.service.name,
        executor=lesson.executor,
        set_up=lambda threads, speed: setup_for(lesson, threads=threads, speed=speed),
        lesson=lesson,
        following=lessons[place + 1] if place + 1 < len(lessons) else None,
    )


def of_exercise(lesson: Lesson, lessons: Sequence[Lesson], file: Path) -> ShownProgram:
    """Return a learner's file for a lesson's exercise as a subject; it runs as it is judged."""
    subject = of_lesson(lesson, lessons)

    def set_up(threads: int | None, speed: float | None) -> RunSetup:
        return replace(request_to_judge(lesson, file), changes=Changes(threads), speed=speed).setup()

    return replace(
        subject,
        heading=f"{subject.heading}: exercise",
        node_path=file,
        executor="as your file says",
        set_up=set_up,
    )


def of_file(path: Path, arguments: Sequence[str], clock: str) -> ShownProgram:
    """Return a program file as a subject."""

    def set_up(threads: int | None, speed: float | None) -> RunSetup:
        return RunRequest(
            files=[path], arguments=arguments, changes=Changes(threads), clock=clock, speed=speed
        ).setup()

    return ShownProgram(
        heading=path.name,
        guide=_GUIDE.format(name=path.name, clock=clock),
        node_path=path,
        service="",
        executor="as the file says",
        set_up=set_up,
    )
