"""Whatever is pressed, clicked and resized, in whatever order: nothing breaks, and ``q`` leaves.

``python -m tests.soak.keys`` goes on for longer, over every screen and with engines.
"""

import asyncio
from collections.abc import Sequence
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.support.builder import ns
from tests.support.console import RecordedConsole
from tests.support.keys import KEYS, OTHERS, SIZES, Place, Step, leave, take
from tests.support.properties import examples
from tests.support.runs import dummy_server_run, shared_group_run

RUNS = {"shared-group": shared_group_run().events, "reentrant-2-threads": dummy_server_run().events}

places = st.builds(Place, st.integers(0, 139), st.integers(0, 39))
steps = st.lists(
    st.one_of(st.sampled_from(KEYS), st.sampled_from((*KEYS, *OTHERS)), st.sampled_from(SIZES), places),
    min_size=5,
    max_size=60,
)


@pytest.mark.usefixtures("in_empty_folder")
@given(lesson=st.sampled_from(sorted(RUNS)), sequence=steps, lost=st.booleans())
@settings(
    max_examples=examples(4),
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
def test_nothing_that_a_person_does_breaks_the_console(lesson: str, sequence: list[Step], lost: bool) -> None:
    asyncio.run(play(lesson, sequence, lost))


async def play(lesson: str, sequence: Sequence[Step], lost: bool) -> None:
    app = RecordedConsole(lesson, RUNS[lesson], 4.0)
    async with app.run_test(size=SIZES[0]) as pilot:
        for place, step in enumerate(sequence):
            await take(pilot, step)
            if place % 5 == 0:
                app.engines.latest.play(ns(4.0 + place / 4))
        if lost and app.is_running:
            app.engines.latest.end("it was killed")
        await leave(pilot)
        assert not app.is_running or app._exit
    assert all(session.stopped for session in app.engines.sessions if session.started)


@pytest.fixture
def in_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Recordings and pictures land where nobody looks; no editor is opened."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("EDITOR", "true")
    monkeypatch.delenv("VISUAL", raising=False)
