"""The program that a screen runs and shows: a lesson of the catalogue, or a learner's own file."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from cbtui.runs.setup.changes import Changes
from cbtui.runs.setup.lesson_setup import RunRequest, request_to_judge, setup_for
from lessons.lesson import Lesson
from sim.engine.setup import RealRos, RobotUse, RunSetup, ServiceChoice
from sim.plural import counted

if TYPE_CHECKING:
    from sim.real.wire import Hello

SetUp: TypeAlias = Callable[[int | None, float | None], RunSetup]
"""Makes a run for a number of threads (None: the program's own) and a speed (None: as fast as possible)."""

_GUIDE = """# {name}

Your own file, on {clock} time. Every thread that runs callbacks has a lane; below are the callback groups, in
the order in which the program fills them, with what waits in them and why.

- `s` calls the first SetBool service that your program offers, `S` the same with false.
- `t` runs it again with another number of threads, `g` with another group for the selected callback, `p` with
  other timers' periods, and tells which line of code would do that.
- `r` puts the robot back to its start, and runs the file again when it is over.

The lessons' robot is there for your file too: `/odom`, `/scan`, `/cmd_vel`, `/reset_world`, `/motor_power`.
"""


_WATCHED_GUIDE = """# Processes on real ROS 2

{processes}

Every thread that runs callbacks has a lane; below are the callback groups, with what waits in them and why.
Nothing is changed about the processes: they go on when you leave.

- `s` calls the first SetBool service that they offer, `S` the same with false.
- `R` records what happens from now on, `d` tells what is wrong.
"""

_ROBOT_GUIDE = """# A robot on your ROS graph

Any node of your ROS domain can drive it: `/odom`, `/scan`, `/cmd_vel`, `/reset_world`, `/motor_power`. What
you start with `cbtui probe -- COMMAND` shows here, too.

- `:` types a `ros2` line: `ros2 topic pub -r 10 /cmd_vel geometry_msgs/msg/Twist "{linear: {x: 0.2}}"`.
- `s` calls `/motor_power` with true, `S` with false; `r` puts the robot back.
"""


@dataclass(frozen=True)
class ShownProgram:
    """A program to run on screen; ``service`` is empty if only its run shows it.

    ``source`` is the program's text if that differs from the file at ``node_path``, ``sources`` the texts of
    a recording, by path.
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
    """Return the program of a lesson, one of ``lessons``."""
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


def of_exercise(
    lesson: Lesson, lessons: Sequence[Lesson], file: Path, real: RealRos | None = None
) -> ShownProgram:
    """Return a learner's file for an exercise; it runs as it is judged, with ``real`` on that ROS 2."""
    subject = of_lesson(lesson, lessons)

    def set_up(threads: int | None, speed: float | None) -> RunSetup:
        changes = Changes(threads, real=real)
        return replace(request_to_judge(lesson, file), changes=changes, speed=speed).setup()

    return replace(
        subject,
        heading=f"{subject.heading}: exercise",
        node_path=file,
        executor="as your file says",
        set_up=set_up,
    )


def of_file(path: Path, arguments: Sequence[str], clock: str) -> ShownProgram:
    """Return a program file."""

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


def of_robot(folder: Path, rate: float | None) -> ShownProgram:
    """Return the robot on real ROS 2, and with it the processes whose probes listen in a folder.

    ``rate`` (Hz) is that of its sensors, None the usual one.
    """
    setup = RunSetup(
        title="robot",
        programs=(),
        clock="real",
        service=ServiceChoice("/motor_power", "std_srvs/srv/SetBool"),
        robot=RobotUse.ALWAYS,
        sensor_rate=rate,
        real=RealRos(watched=str(folder)),
    )
    return ShownProgram(
        heading="a robot on your ROS graph",
        guide=_ROBOT_GUIDE,
        node_path=Path(),
        service="/motor_power",
        executor="as the programs say",
        set_up=lambda _threads, _speed: setup,
    )


def of_processes(real: RealRos, found: Sequence["Hello"]) -> ShownProgram:
    """Return processes that others have started as a subject; ``found`` are those that are there now.

    The first one of those has its program shown.
    """
    title = counted(len(found), "process")
    setup = watched_setup(title, real)
    lines = [f"- `{' '.join(each.command)}` ({each.process}, Python {each.python})" for each in found]
    return ShownProgram(
        heading=f"watched: {title}",
        guide=_WATCHED_GUIDE.format(processes="\n".join(lines)),
        node_path=Path(found[0].command[1] if len(found[0].command) > 1 else ""),
        service="",
        executor="as the programs say",
        set_up=lambda _threads, _speed: setup,
    )


def watched_setup(title: str, real: RealRos) -> RunSetup:
    """Return the set-up of a run that only watches what others have started."""
    return RunSetup(title=title, programs=(), clock="real", robot=RobotUse.NEVER, real=real)
