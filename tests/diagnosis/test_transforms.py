"""Lookups of tf that keep out the transforms that they wait for, and what is not said about ``/tf``."""

from pathlib import Path

import pytest

from sim.diagnosis import diagnose
from tests.support.engine_runs import run_program

LOOKUP = (Path(__file__).parent / "beginners" / "lookup_in_timer.py").read_text()
ASLEEP = LOOKUP.replace("self.buf.lookup_transform(", "__import__('time').sleep(2.0), (")
ASKS = ASLEEP.replace("t = TransformStamped()", "t = TransformStamped()\n        self.buf.can_transform")


@pytest.mark.parametrize(
    ("program", "stale"),
    [(LOOKUP, set()), (ASLEEP, set()), (ASKS, {"send"})],
    ids=["looks up", "asleep", "asks"],
)
def test_only_a_timer_that_asks_for_transforms_is_said_to_run_on_old_ones(
    program: str, stale: set[str], tmp_path: Path
) -> None:
    timeline = run_program(tmp_path, program, 4.0).timeline
    told = (each for each in diagnose(timeline) if each.rule.id == "stale-data")
    assert {timeline.entities[each.subject].callback for each in told} == stale
