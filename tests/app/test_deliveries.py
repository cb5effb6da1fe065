"""What an engine tells at once is taken in parts, so that keys have their turn in between."""

import asyncio
from time import monotonic

import pytest

from cbtui.runs.live.live_run import LiveRun
from sim.trace.events import AnyEvent, Printed
from tests.support.builder import ns
from tests.support.console import WIDE, RecordedConsole, settle
from tests.support.exercises import until
from tests.support.runs import shared_group_run


async def test_a_long_batch_is_taken_in_parts_and_in_order(monkeypatch: pytest.MonkeyPatch) -> None:
    taken: list[list[AnyEvent]] = []

    def take(_run: LiveRun, events: list[AnyEvent]) -> None:
        taken.append(events)

    app = RecordedConsole("shared-group", shared_group_run().events, 5.0)
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        monkeypatch.setattr(LiveRun, "take", take)
        batch: list[AnyEvent] = [Printed(ns(5) + number, "x" * 4096, error=False) for number in range(2000)]
        app.lesson_screen._deliver(app.lesson_screen._runs, batch)
        await settle(pilot)
    assert [event for part in taken for event in part] == batch
    assert max(map(len, taken)) <= 256


async def test_a_long_batch_comes_slowly_while_a_key_is_answered_and_whole(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("cbtui.screens.lesson.running._REST", 0.1)
    monkeypatch.setattr("cbtui.screens.lesson.running._ANSWERING", 60.0)
    app = RecordedConsole("shared-group", shared_group_run().events, 5.0)
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        screen = app.lesson_screen
        logs = len(screen.live_run.timeline.logs)
        batch: list[AnyEvent] = [Printed(ns(5) + number, "x", error=False) for number in range(3 * 256)]
        await pilot.press("1")
        pressed = monotonic()
        await asyncio.to_thread(screen._deliver, screen._runs, batch)
        assert monotonic() - pressed >= 0.1
        await settle(pilot)
        assert len(screen.live_run.timeline.logs) == logs + len(batch)


async def test_a_session_may_deliver_a_long_batch_to_a_screen_that_is_gone() -> None:
    app = RecordedConsole("shared-group", shared_group_run().events, 5.0)
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        screen = app.lesson_screen
        await pilot.press("q")
        await until(pilot, lambda: not screen.is_attached)
        batch: list[AnyEvent] = [Printed(ns(5) + number, "x", error=False) for number in range(2 * 256)]
        # As on the session's own thread, which knows no app: asyncio.to_thread would hand it on.
        await asyncio.get_running_loop().run_in_executor(None, screen._deliver, screen._runs, batch)
