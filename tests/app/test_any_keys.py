"""Whatever is pressed, clicked and resized, in whatever order: nothing breaks, and ``q`` leaves.

``CBTUI_KEY_RUNS`` says how many sequences of up to 60 steps are tried, 12 if it says nothing.
"""

import asyncio
import os
from collections.abc import Sequence
from pathlib import Path
from typing import TypeAlias

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from textual.pilot import OutOfBounds, Pilot

from cbtui.actions import ACTIONS
from tests.support.builder import ns
from tests.support.console import RecordedConsole
from tests.support.runs import dummy_server_run, shared_group_run

RUNS = {"shared-group": shared_group_run().events, "reentrant-2-threads": dummy_server_run().events}
SIZES = ((80, 24), (140, 40), (100, 30), (79, 23), (20, 5), (250, 70))

Step: TypeAlias = "str | tuple[int, int]"
"""A key; a size of the terminal; or, as ``(-column, -row)``, a place to click on."""

LEAVE_ALONE = {"ctrl+c"}
"""Keys that a terminal may have another meaning for."""

KEYS = sorted({key for action in ACTIONS for key in action.key.split(",")} - LEAVE_ALONE)
OTHERS = ("home", "end", "pageup", "pagedown", "backspace", "delete", "shift+tab", "x", "1", "ä", "f5")
LEAVES = 12
"""How many times ``escape`` and ``q`` have to lead out of wherever one is: windows lie above windows."""

places = st.tuples(st.integers(-139, 0), st.integers(-39, 0))
steps = st.lists(
    st.one_of(st.sampled_from(KEYS), st.sampled_from((*KEYS, *OTHERS)), st.sampled_from(SIZES), places),
    min_size=5,
    max_size=60,
)


@pytest.mark.usefixtures("in_empty_folder")
@given(lesson=st.sampled_from(sorted(RUNS)), sequence=steps, lost=st.booleans())
@settings(
    max_examples=int(os.environ.get("CBTUI_KEY_RUNS", "12")),
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
        await leave(app, pilot)
        assert not app.is_running or app._exit
    assert all(session.stopped for session in app.engines.sessions if session.started)


async def take(pilot: Pilot[None], step: Step) -> None:
    match step:
        case str():
            await pilot.press(step)
        case (width, height) if width > 0:
            await pilot.resize_terminal(width, height)
        case (column, row):
            try:
                await pilot.click(offset=(-column, -row))
            except OutOfBounds:
                await pilot.pause()


async def leave(app: RecordedConsole, pilot: Pilot[None]) -> None:
    """Do what a person does who wants to be gone."""
    for _ in range(LEAVES):
        if app._exit:
            return
        await pilot.press("escape")
        if not app._exit:
            await pilot.press("q")
    await pilot.pause()


@pytest.fixture
def in_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Recordings and pictures land where nobody looks; no editor is opened."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("EDITOR", "true")
    monkeypatch.delenv("VISUAL", raising=False)
