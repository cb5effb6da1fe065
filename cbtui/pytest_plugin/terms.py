"""The terms of a test's run: what the mark says, what the call says, and the set-up that comes of them."""

import argparse
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from cbtui.commands.options import values
from cbtui.commands.options.changes import real_ros
from cbtui.runs.setup.changes import Changes
from cbtui.runs.setup.lesson_setup import RunRequest, request_to_judge
from lessons.lesson import Lesson
from sim.engine.setup import RealRos, RunSetup

DEFAULT_SECONDS = 10.0


class BadTermsError(ValueError):
    """Terms that contradict each other, or are unknown; the text is a sentence."""


@dataclass(frozen=True, kw_only=True)
class RunTerms:
    """How a program is run; ``limit`` is in real seconds for each schedule, all else in the run's own time.

    ``seconds`` None is 10, for a lesson as long as it says. ``groups`` and ``periods`` (seconds) are by
    callback, or by ``node:callback``. ``schedules`` are so many orders of threads, the usual one first;
    ``seed`` is a single one.
    """

    seconds: float | None = None
    calls: Sequence[float] = ()
    lines: Sequence[tuple[float, str]] = ()
    arguments: Sequence[str] = ()
    threads: int | None = None
    groups: Mapping[str, str] = field(default_factory=dict)
    periods: Mapping[str, float] = field(default_factory=dict)
    sensor_rate: float | None = None
    schedules: int = 1
    seed: int | None = None
    on: str = "model"
    python: str | None = None
    robot: bool = True
    limit: float = 60.0

    def __post_init__(self) -> None:
        if self.on not in {"model", "ros2"}:
            raise BadTermsError(f"on={self.on!r} is neither 'model' nor 'ros2'")
        if self.schedules < 1:
            raise BadTermsError(f"schedules={self.schedules} are too few; give 1 or more")
        if self.python is not None and self.on == "model":
            raise BadTermsError("python= names the Python of a real ROS 2: give on='ros2' with it")

    @property
    def seeds(self) -> Sequence[int]:
        """The orders of threads that are run, by their seeds."""
        if self.on == "ros2":
            return (0,)
        return range(self.schedules) if self.seed is None else (self.seed,)

    def changed(self, given: Mapping[str, Any]) -> "RunTerms":
        """The same with other values.

        Raises:
            BadTermsError: a name is unknown, or values contradict each other.
        """
        unknown = given.keys() - self.__dataclass_fields__.keys()
        if unknown:
            known = ", ".join(self.__dataclass_fields__)
            raise BadTermsError(f"cbtui knows no {sorted(unknown)[0]}=; there are {known}")
        return replace(self, **given)

    def setup(self, lesson: Lesson | None, files: Sequence[Path]) -> RunSetup:
        """The set-up of the run of files, of a lesson, or of a lesson with a file in its node's place.

        Raises:
            BadTermsError: a value is out of its range.
        """
        request = RunRequest(files=files, arguments=self.arguments, clock="virtual", seconds=DEFAULT_SECONDS)
        if lesson is not None:
            request = request_to_judge(lesson, *files)
        if self.seconds is not None:
            request = replace(request, seconds=self.seconds)
        changes = Changes(
            request.changes.threads if self.threads is None else self.threads,
            dict(_read(values.group_change, self.groups)),
            dict(_read(values.period_change, self.periods)),
            sensor_rate=self.sensor_rate,
            real=self._real(),
        )
        return replace(
            request,
            changes=changes,
            robot=self.robot,
            calls=self.calls or request.calls,
            lines=self.lines or request.lines,
        ).setup()

    def _real(self) -> RealRos | None:
        if self.on == "model":
            return None
        try:
            return real_ros(self.python)
        except SystemExit:
            sentence = (
                "on='ros2' needs a Python with rclpy: pip install 'cbtui[ros]', or name it with python="
            )
            raise BadTermsError(sentence) from None


def _read(parse: Any, given: Mapping[str, Any]) -> list[Any]:
    try:
        return [parse(f"{place}={value}") for place, value in given.items()]
    except argparse.ArgumentTypeError as error:
        raise BadTermsError(str(error)) from None
