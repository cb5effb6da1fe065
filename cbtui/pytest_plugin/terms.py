"""The terms of a test's run, from its marks and the call, and the set-up that they make."""

import argparse
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from cbtui.commands.options import inputs, values
from cbtui.commands.options.changes import NoRealRosError, real_ros
from cbtui.runs.setup.changes import Changes
from cbtui.runs.setup.lesson_setup import RunRequest, request_to_judge
from lessons.lesson import Lesson
from sim.clock.schedule import Seed
from sim.engine.setup import RunSetup

DEFAULT_SECONDS = 10.0


class BadTermsError(ValueError):
    """Terms that contradict each other, or are unknown; the text is a sentence."""


@dataclass(frozen=True, kw_only=True)
class RunTerms:
    """How a program is run; ``limit`` is in real seconds for each schedule, all else in the run's own time.

    ``seconds`` None is 10, for a lesson its own length. ``groups`` and ``periods`` (seconds) are by callback,
    or by ``node:callback``. ``schedules`` is a number of thread schedules, the usual one first; ``seed`` is a
    single one. The values are those of the options of the same names of ``cbtui run``.
    """

    seconds: float | None = None
    calls: Sequence[float] = ()
    lines: Sequence[tuple[float, str]] = ()
    arguments: Sequence[str] = ()
    threads: int | None = None
    groups: Mapping[str, str] = field(default_factory=dict)
    periods: Mapping[str, float] = field(default_factory=dict)
    sensor_rate: float | None = None
    distro: str | None = None
    schedules: int = 1
    seed: Seed | None = None
    on: str = "model"
    python: str | None = None
    robot: bool = True
    limit: float = 60.0

    def __post_init__(self) -> None:
        for name, read in _READERS.items():
            value = getattr(self, name)
            try:
                if value is not None:
                    read(value)
            except argparse.ArgumentTypeError as error:
                raise BadTermsError(f"{name}={value!r}: {error}") from None
        if self.python is not None and self.on == "model":
            raise BadTermsError("python= names the Python of a real ROS 2: give on='ros2' with it")

    @property
    def seeds(self) -> Sequence[Seed]:
        """The seeds of the thread schedules to run."""
        if self.on == "ros2":
            return (0,)
        return range(self.schedules) if self.seed is None else (values.schedule(str(self.seed)),)

    @property
    def callbacks(self) -> Sequence[str]:
        """The names of the changed callbacks, without their nodes."""
        return [place.rpartition(":")[2] for place in (*self.groups, *self.periods)]

    def changed(self, given: Mapping[str, Any]) -> "RunTerms":
        """Return the terms with other values.

        Raises:
            BadTermsError: a name is unknown, or values contradict each other.
        """
        unknown = given.keys() - self.__dataclass_fields__.keys()
        if unknown:
            known = ", ".join(self.__dataclass_fields__)
            raise BadTermsError(f"cbtui knows no {sorted(unknown)[0]}=; there are {known}")
        return replace(self, **given)

    def setup(self, lesson: Lesson | None, files: Sequence[Path]) -> RunSetup:
        """Return the set-up for files, a lesson, or a lesson with a file in its node's place.

        Raises:
            BadTermsError: a value is out of its range.
        """
        request = RunRequest(files=files, arguments=self.arguments, clock="virtual", seconds=DEFAULT_SECONDS)
        if lesson is not None:
            request = request_to_judge(lesson, *files)
        if self.seconds is not None:
            request = replace(request, seconds=self.seconds)
        try:
            real = None if self.on == "model" else real_ros(self.python)
        except NoRealRosError as error:
            raise BadTermsError(f"on='ros2': {error}") from None
        if request.seconds is not None and (late := inputs.late(request.seconds, self.calls, self.lines)):
            raise BadTermsError(late)
        changes = Changes(
            request.changes.threads if self.threads is None else self.threads,
            dict(map(values.group_change, _assigned(self.groups))),
            dict(map(values.period_change, _assigned(self.periods))),
            sensor_rate=self.sensor_rate,
            real=real,
            distro=self.distro,
        )
        return replace(
            request,
            changes=changes,
            robot=self.robot,
            calls=self.calls or request.calls,
            lines=self.lines or request.lines,
        ).setup()


def _assigned(given: Mapping[str, Any]) -> list[str]:
    """Callbacks and their values in the form of the command line."""
    return [f"{place}={value}" for place, value in given.items()]


def _ground(on: object) -> None:
    if on not in {"model", "ros2"}:
        raise argparse.ArgumentTypeError("give 'model' or 'ros2'")


def _number(read: Callable[[str], object]) -> Callable[[object], None]:
    """Return a reader of numbers that refuses text, which the users of the value could not read."""

    def check(value: object) -> None:
        if isinstance(value, str | bool):
            raise argparse.ArgumentTypeError("give a number, without quotation marks")
        read(str(value))

    return check


def _each(read: Callable[[Any], object], such_as: str) -> Callable[[object], None]:

    def check(value: object) -> None:
        if isinstance(value, str) or not isinstance(value, Sequence):
            raise argparse.ArgumentTypeError(f"give a list, such as {such_as}")
        for each in value:
            read(each)

    return check


def _by_callback(read: Callable[[str], object], such_as: str) -> Callable[[object], None]:

    def check(value: object) -> None:
        if not isinstance(value, Mapping):
            raise argparse.ArgumentTypeError(f"give a dict, such as {such_as}")
        for each in _assigned(value):
            read(each)

    return check


def _line(value: object) -> None:
    match value:
        case (at, str()):
            _number(values.moment)(at)
        case _:
            raise argparse.ArgumentTypeError(f"give each line its moment, such as {_LINE}")


def _word(value: object) -> None:
    if not isinstance(value, str):
        raise argparse.ArgumentTypeError(f"{value!r} is not text")


_LINE = "(2.0, 'ros2 topic list')"
_READERS: Mapping[str, Callable[[Any], object]] = {
    "seconds": _number(values.duration),
    "calls": _each(_number(values.moment), "[2.5]"),
    "lines": _each(_line, f"[{_LINE}]"),
    "arguments": _each(_word, "['-speed', '0.5']"),
    "threads": _number(values.threads),
    "groups": _by_callback(values.group_change, "{'odom_callback': 'own'}"),
    "periods": _by_callback(values.period_change, "{'timer_callback': 0.2}"),
    "sensor_rate": _number(values.sensor_rate),
    "distro": values.distro,
    "schedules": _number(values.count),
    "seed": lambda value: values.schedule(str(value)),
    "on": _ground,
    "limit": _number(values.duration),
}
"""The readers that validate the terms with the messages of the command line."""
