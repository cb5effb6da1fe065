"""How each lesson looks at a moment of its own run, by a real engine on virtual time."""

from collections.abc import Callable
from functools import cache

import pytest

from sim.trace.events import AnyEvent
from tests.support.console import NARROW, WIDE, RecordedConsole, settle
from tests.support.engine_runs import run_lesson

BETWEEN = (100, 30)
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


@cache
def events_of(lesson: str) -> tuple[AnyEvent, ...]:
    seconds, calls = MOMENTS[lesson]
    return tuple(run_lesson(lesson, seconds + 1, *calls).events)


SIZES = {"80x24": NARROW, "100x30": BETWEEN, "140x40": WIDE}
PICTURES = [
    *((size, "dark") for size in SIZES),
    *(("140x40", look) for look in ("light", "no-colour", "ascii")),
]


@pytest.mark.parametrize(("size", "look"), PICTURES)
@pytest.mark.parametrize("lesson", MOMENTS)
def test_a_lesson_looks_as_it_did(
    snap_compare: Callable[..., bool],
    monkeypatch: pytest.MonkeyPatch,
    lesson: str,
    size: str,
    look: str,
) -> None:
    if look == "no-colour":
        monkeypatch.setenv("NO_COLOR", "1")
    charset = "ascii" if look == "ascii" else "braille"
    theme = "light" if look == "light" else "dark"
    seconds, _ = MOMENTS[lesson]
    app = RecordedConsole(lesson, events_of(lesson), seconds, charset=charset, theme=theme)
    assert snap_compare(app, terminal_size=SIZES[size], run_before=settle)
