"""The schema of `lesson.toml`: its tables and fields, and their allowed values."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Annotated, Literal

import msgspec
from msgspec import Meta, Struct

from sim.releases.profile import Profile

Text = Annotated[str, Meta(min_length=1)]
LessonId = Annotated[str, Meta(pattern=r"^[a-z0-9]+(-[a-z0-9]+)*$")]
Number = Annotated[int, Meta(ge=1)]
Threads = Annotated[int, Meta(ge=1, le=64)]
Seconds = Annotated[float, Meta(gt=0, le=3600)]
Moment = Annotated[float, Meta(ge=0)]
PythonFile = Annotated[str, Meta(pattern=r"^\w+\.py$")]
NodeFile = Annotated[str, Meta(pattern=r"^(\.\./[a-z0-9]+(-[a-z0-9]+)*/)?\w+\.py$")]
FunctionName = Annotated[str, Meta(pattern=r"^[a-z_]\w*$")]
RuleId = Annotated[str, Meta(pattern=r"^[a-z]+(-[a-z]+)*$")]
ServiceName = Annotated[str, Meta(pattern=r"^(/[A-Za-z_]\w*)+$")]
ServiceType = Annotated[str, Meta(pattern=r"^[a-z]\w*/srv/[A-Z]\w*$")]


class Setup(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Which node a lesson runs, and how it is started."""

    node: NodeFile
    """File name of the node, in the lesson's folder, or as ``../two-threads/node.py`` in another lesson's."""
    arguments: tuple[str, ...] = ()
    """Command line of the node, without the program's name."""
    threads_argument: Text | None = None
    """The argument that carries the number of threads; None when the node fixes its executor itself."""
    distro: str = ""
    """The release of rclpy for which it is, in the form of `--distro`; empty for the usual one."""
    not_on_ros2: str = ""
    """Why a run on real ROS 2 may not show the answers, as the end of a sentence; empty if it does."""
    clock: Literal["virtual", "real"] = "virtual"
    """The node's clock. On virtual time computing takes no time; a lesson on computing needs the real clock,
    and checks and answers with the same results on a busy machine."""

    def __post_init__(self) -> None:
        if self.arguments and self.arguments[-1] == self.threads_argument:
            raise ValueError(f"{self.threads_argument} stands last in arguments and has no number after it")
        if self.distro:
            Profile.named(self.distro)


class Setting(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A number on the node's command line that a learner can change."""

    name: Text
    """What it is, in a few words."""
    argument: Text
    """The argument with the number; the set-up's arguments contain it, followed by its usual value."""
    unit: Text
    least: float
    most: float

    def __post_init__(self) -> None:
        if not self.least < self.most:
            raise ValueError(f"the least {self.least:g} is not below the most {self.most:g}")


class LessonService(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The service that a lesson's `s` key calls."""

    name: ServiceName
    type: ServiceType


class Try(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One thing a learner is invited to do: the key to press and what to look for."""

    key: Text
    text: Text


class Actor(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A figure of a lesson's scene, which moves as a callback runs."""

    figure: Literal[
        "antenna",
        "bell",
        "belt",
        "camera",
        "clamp",
        "crane",
        "gripper",
        "hand",
        "heart",
        "lamp",
        "lorry",
        "oven",
        "scales",
        "watchman",
    ]
    follows: Text
    """The callback by its name, or its topic or service."""


class Prediction(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A question that is answered before the run; the run then shows which answer is true."""

    question: Text
    answers: Annotated[tuple[Text, ...], Meta(min_length=2, max_length=5)]
    right: Annotated[int, Meta(ge=0)]
    """Index of the true answer, from 0."""
    because: Text
    """Why that is so, in a sentence or two."""
    shown: FunctionName
    """The function in the lesson's `checks.py` that returns which answer a run shows to be true."""

    def __post_init__(self) -> None:
        if self.right >= len(self.answers):
            raise ValueError(
                f"right is {self.right}, and the last answer has the number {len(self.answers) - 1}"
            )
        if len(set(self.answers)) < len(self.answers):
            raise ValueError("two answers are the same")


class LessonRun(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The run of predictions, checks and declared diagnoses. Times are in seconds of its clock."""

    seconds: Seconds = 30.0
    calls: tuple[Moment, ...] = ()
    """When the lesson's service is called, with true."""
    lines: tuple[tuple[Moment, Text], ...] = ()
    """`ros2` lines that are carried out, each with its moment."""
    threads: Threads | None = None
    """Threads of the executor of the lesson's node instead of its own; a learner's file keeps its own."""

    def __post_init__(self) -> None:
        for what, at in (*(("call", at) for at in self.calls), *(("line", at) for at, _ in self.lines)):
            if at >= self.seconds:
                raise ValueError(f"a {what} at {at:g} s comes when the run of {self.seconds:g} s is over")


class Exercise(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A task for the learner's own file; the checks of `checks.py` tell whether it is solved."""

    asks: Text
    """What is to be done, in a few sentences."""
    hints: tuple[Text, Text, Text]
    """From a nudge to nearly the answer."""
    starter: PythonFile = "starter.py"
    """The file that a learner begins with; at least one check fails on it."""
    solution: PythonFile = "solution.py"
    """A file that passes every check."""
    beyond_node: Text | None = None
    """Lines that starter and solution share and the node lacks; all other shared lines are the node's."""
    scene: Annotated[tuple[Actor, ...], Meta(max_length=4)] = ()
    """The figures of the exercise, if those of the lesson are too few."""


class DeclaredDiagnoses(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The ids of the rules that find a problem, exactly those, in the run of each file."""

    node: tuple[RuleId, ...] = ()
    starter: tuple[RuleId, ...] = ()
    solution: tuple[RuleId, ...] = ()
    shows: tuple[RuleId, ...] = ()
    """Kinds of problems that refer to the lesson, besides those of ``node``."""


class Description(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The content of a `lesson.toml`."""

    id: LessonId
    """Name of the lesson on the command line; the lesson's folder has the same name."""
    number: Number
    """Orders the lessons that lie together, with gaps for more; on screen they are counted from 1."""
    unit: Text
    title: Text
    teaches: Text
    teaser: Text | None = None
    """The previous lesson's text on this one, after its title: ``puts both callbacks in one open area.``"""
    executor: Text
    """The executor as the menu shows it."""
    groups: Text
    """The callback groups as the menu shows them."""
    setup: Setup
    service: LessonService
    task: Text | None = None
    """What to do while the lesson runs, so that there is something to see."""
    tries: tuple[Try, ...] = msgspec.field(name="try", default=())
    settings: tuple[Setting, ...] = msgspec.field(name="setting", default=())
    scene: Annotated[tuple[Actor, ...], Meta(max_length=4)] = ()
    """The figures that are shown in place of a robot that would not move."""
    predictions: Annotated[tuple[Prediction, ...], Meta(max_length=2)] = msgspec.field(
        name="prediction", default=()
    )
    run: LessonRun = LessonRun()
    exercise: Exercise | None = None
    diagnoses: DeclaredDiagnoses = DeclaredDiagnoses()

    def __post_init__(self) -> None:
        for setting in self.settings:
            if number_after(setting.argument, self.setup.arguments) is None:
                sentence = f"the setting {setting.name!r} needs {setting.argument} and a number in arguments"
                raise ValueError(sentence)
        if self.exercise is None and (self.diagnoses.starter or self.diagnoses.solution):
            raise ValueError("diagnoses of a starter or a solution need an exercise")


def with_argument(arguments: Sequence[str], name: str, value: str) -> list[str]:
    """Return a command line on which an argument has a value; it comes last if it was not there."""
    replaced = list(arguments)
    if name not in replaced[:-1]:
        return [*replaced, name, value]
    replaced[replaced.index(name) + 1] = value
    return replaced


def number_after(name: str, arguments: Sequence[str]) -> float | None:
    """Return the value of an argument on a command line as a number; None if there is none."""
    for argument, value in pairwise(arguments):
        if argument == name:
            try:
                return float(value)
            except ValueError:
                return None
    return None
