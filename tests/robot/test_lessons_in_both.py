"""The course's lessons, whichever physics moves the robot."""

import math
import re

import msgspec
import pytest

from cbtui.runs.setup.lesson_setup import setup_for
from lessons.catalogue import find
from sim.engine.setup import PhysicsChoice
from sim.trace.events import RobotMoved
from tests.support.daily import first_slow
from tests.support.engine_runs import SECOND, Run, run_to_end

COURSE = (
    "split-groups",
    "single-thread",
    "shared-group",
    "exclusive-2-threads",
    "reentrant-2-threads",
    "reentrant-1-thread",
)
RANGE = re.compile(r"(?<=Value=)[\d.]+|inf")


def lines(run: Run) -> list[tuple[float, str]]:
    """When each line was logged, and its text without what the laser measured."""
    return [(at, RANGE.sub("…", text)) for at, text in run.logs()]


def places(run: Run) -> list[tuple[float, float]]:
    return [(event.x, event.y) for event in run.events if isinstance(event, RobotMoved)]


@pytest.mark.parametrize("lesson", first_slow(*COURSE))
def test_a_minute_of_a_lesson_has_the_same_log_and_places_in_both(lesson: str) -> None:
    pytest.importorskip("pybullet")
    setup = msgspec.structs.replace(setup_for(find(lesson), speed=None), until=60 * SECOND)
    one, other = (run_to_end(msgspec.structs.replace(setup, physics=choice)) for choice in PhysicsChoice)
    assert lines(one) == lines(other)
    assert len(lines(one)) > 50
    apart = [math.dist(*pair) for pair in zip(places(one), places(other), strict=True)]
    assert 0 < max(apart) < 0.02  # no run of the same physics twice
