"""A callback that hangs for good fails the schedule, in the words of the rule that finds it."""

from pathlib import Path

import pytest

from sim.diagnosis import RULES
from tests.exploring.strategies import exploration

_BEGINNERS = Path(__file__).parents[1] / "diagnosis" / "beginners"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("program", "rule"),
    [
        ("call_in_timer", "self-made-deadlock"),
        ("call_in_reentrant_timer", "needs-one-more-worker"),
        ("wait_for_service", "service-never-comes"),
        ("while_sleeping", "stays-in-loop"),
    ],
)
def test_a_callback_that_hangs_fails_its_schedule(program: str, rule: str, tmp_path: Path) -> None:
    source = (_BEGINNERS / f"{program}.py").read_text()
    ((_, result),) = exploration(source, tmp_path, seconds=8).results(["1"], processes=1)
    assert [each.summary for each in RULES if each.id == rule] == [each.what for each in result.failures]
