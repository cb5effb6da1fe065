"""How each lesson looks at a moment of its own run, by a real engine on virtual time."""

from collections.abc import Callable

import pytest

from tests.support.console import NARROW, WIDE, RecordedConsole, settle
from tests.support.engine_runs import run_lesson

TURNING = 12.48
"""Seconds: the robot lessons are in the middle of their first turn."""
BUSY = 5.2
"""Seconds: the server is in the middle of the call that came at 2.55 s."""

MOMENTS = {
    "single-thread": (TURNING, ()),
    "shared-group": (TURNING, ()),
    "split-groups": (TURNING, ()),
    "exclusive-2-threads": (BUSY, (2.55,)),
    "reentrant-2-threads": (BUSY, (2.55,)),
    "reentrant-1-thread": (BUSY, (2.55,)),
}


@pytest.mark.parametrize("size", [NARROW, WIDE], ids=["80x24", "140x40"])
@pytest.mark.parametrize("lesson", MOMENTS)
def test_a_lesson_looks_as_it_did(
    snap_compare: Callable[..., bool], lesson: str, size: tuple[int, int]
) -> None:
    seconds, calls = MOMENTS[lesson]
    events = run_lesson(lesson, seconds + 1, *calls).events
    assert snap_compare(RecordedConsole(lesson, events, seconds), terminal_size=size, run_before=settle)
