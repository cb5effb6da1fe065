"""The program that a screen runs and shows: a lesson of the catalogue, or a learner's own file."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

import msgspec

from cbtui.runs.setup.changes import Changes
from cbtui.runs.setup.lesson_setup import RunRequest, request_to_judge, setup_for
from lessons.description import Actor
from lessons.lesson import Lesson
from lessons.puzzles import SECONDS, Puzzle
from sim.engine.inputs import inputs_of
from sim.engine.setup import Keyboard, PhysicsChoice, RealRos, RobotUse, RunSetup, ServiceChoice
from sim.quantities.nanoseconds import SECOND
from sim.quantities.plural import counted
from sim.trace.events import AnyEvent
from sim.trace.model import Nanoseconds

if TYPE_CHECKING:
    from sim.real.wire import Hello
    from sim.trace.timeline import Timeline

SetUp: TypeAlias = Callable[[int | None, float | None], RunSetup]
"""Makes a run for a number of threads (None: the program's own) and a speed (None: as fast as possible)."""

_FROM_MOMENT = 10 * SECOND
"""Length of a run from the moment on at which the learner begins to schedule its threads."""

_CHOOSING_GUIDE = """# {title}

{task}

Time stands still wherever more than one thread can go on, and you choose which one does. The first one goes
on by itself; to choose another is a move.

- `1`, `2` … or the arrow keys and `enter` choose; the code shows where the highlighted thread stands.
- `u` takes the last choice back, `r` begins again, `space` lets the rest go on by itself.
{keys}
A thread is left only in front of a line that touches what another callback changes, at a lock, or at a call
of ROS. What cannot go on is listed with its reason: that is what rclpy allows, and no choice of yours.
"""
_PUZZLE_KEYS = """- `H` begins again and shows the solution, choice by choice.
- `e` opens the lesson that the puzzle belongs to.
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
    a recording, by path. ``is_own_file`` tells that it is a file which the learner edits, whose guide is
    written as it runs. ``scene`` are the figures in place of a robot. ``counts_processes`` has the heading
    tell how many processes there are.
    """

    heading: str
    guide: str
    node_path: Path
    service: str
    executor: str
    set_up: SetUp
    lesson: Lesson | None = None
    following: Lesson | None = None
    scene: tuple[Actor, ...] = ()
    source: str | None = None
    sources: Mapping[str, str] = field(default_factory=dict)
    is_own_file: bool = False
    counts_processes: bool = False

    @property
    def is_learners(self) -> bool:
        """Whether it is no lesson's own node, but the file of an exercise, or any other program."""
        return self.lesson is None or self.node_path != self.lesson.node_path

    def heading_of(self, timeline: "Timeline") -> str:
        """Return the heading of a run, with what is known at its end."""
        if not self.counts_processes:
            return self.heading
        running = timeline.processes.keys() - timeline.processes_ended.keys()
        return f"{self.heading}: {counted(len(running), 'process')}"


def of_lesson(lesson: Lesson, lessons: Sequence[Lesson]) -> ShownProgram:
    """Return the program of a lesson, one of ``lessons``."""
    place = lessons.index(lesson)
    return ShownProgram(
        heading=f"{lesson.number} {lesson.title}",
        guide=lesson.guide,
        node_path=lesson.node_path,
        service=lesson.service.name,
        executor=lesson.executor,
        set_up=lambda threads, speed: setup_for(lesson, threads=threads, speed=speed),
        lesson=lesson,
        following=lessons[place + 1] if place + 1 < len(lessons) else None,
        scene=lesson.scene,
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
        node_path=file,
        executor="as your file says",
        set_up=set_up,
        scene=(lesson.exercise.scene if lesson.exercise is not None else ()) or lesson.scene,
    )


def of_file(path: Path, arguments: Sequence[str], clock: str) -> ShownProgram:
    """Return a program file."""

    def set_up(threads: int | None, speed: float | None) -> RunSetup:
        return RunRequest(
            files=[path], arguments=arguments, changes=Changes(threads), clock=clock, speed=speed
        ).setup()

    return ShownProgram(
        heading=path.name,
        guide="",
        node_path=path,
        service="",
        executor="as the file says",
        set_up=set_up,
        is_own_file=True,
    )


def of_puzzle(puzzle: Puzzle) -> ShownProgram:
    """Return the program of a puzzle."""
    setup = RunRequest(files=[puzzle.node_path], clock="virtual", seconds=SECONDS).setup()
    return ShownProgram(
        heading=f"Puzzle: {puzzle.title}",
        guide=_CHOOSING_GUIDE.format(title=puzzle.title, task=puzzle.task, keys=_PUZZLE_KEYS),
        node_path=puzzle.node_path,
        service="",
        executor="as the puzzle says",
        set_up=lambda _threads, _speed: setup,
    )


def of_moment(
    subject: ShownProgram, run: RunSetup, events: Iterable[AnyEvent], at: Nanoseconds
) -> ShownProgram:
    """Return a program as the learner schedules it from the moment ``at`` of a run with these ``events``."""
    setup = msgspec.structs.replace(
        run,
        speed=None,
        until=at + _FROM_MOMENT,
        explored_from=at,
        inputs=inputs_of(events),
        keyboard=Keyboard.NOBODY if run.keyboard is Keyboard.NOBODY else Keyboard.REPEATED,
    )
    return replace(
        subject,
        heading=f"{subject.heading}: you choose",
        guide=_CHOOSING_GUIDE.format(
            title="You are the scheduler",
            task="The run is repeated up to the moment where you paused it.",
            keys="- `q` goes back to the paused run.\n",
        ),
        set_up=lambda _threads, _speed: setup,
        lesson=None,
        following=None,
        is_own_file=False,
    )


def of_robot(folder: Path, rate: float | None, physics: PhysicsChoice | None = None) -> ShownProgram:
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
        physics=physics,
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
    setup = watched_setup("watched", real)
    lines = [f"- `{' '.join(each.command)}` ({each.process}, Python {each.python})" for each in found]
    return ShownProgram(
        heading="watched",
        guide=_WATCHED_GUIDE.format(processes="\n".join(lines)),
        node_path=Path(found[0].command[1] if len(found[0].command) > 1 else ""),
        service="",
        executor="as the programs say",
        set_up=lambda _threads, _speed: setup,
        counts_processes=True,
    )


def watched_setup(title: str, real: RealRos) -> RunSetup:
    """Return the set-up of a run that only watches what others have started."""
    return RunSetup(title=title, programs=(), clock="real", robot=RobotUse.NEVER, real=real)
