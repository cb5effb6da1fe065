"""What an engine tells at once is taken in parts, so that keys have their turn in between."""

import asyncio
from time import monotonic

import pytest
from textual.message import Message

from cbtui.runs.live.live_run import LiveRun
from cbtui.screens.parts.runs import RunController
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
        app.lesson_screen.runs.deliver(app.lesson_screen.runs.number, batch)
        await settle(pilot)
    assert [event for part in taken for event in part] == batch
    assert max(map(len, taken)) <= 256


async def test_after_each_part_a_session_rests_for_as_long_as_the_machine_let_it_wait(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    waits: list[bool] = []

    def waited(_since: float) -> float:
        waits.append(all(part.taken.is_set() for part in handed_over))
        return 0.05

    monkeypatch.setattr("cbtui.screens.parts.runs.cpu_wait", waited)
    handed_over: list[RunController.Delivered] = []
    app = RecordedConsole("shared-group", shared_group_run().events, 5.0)
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        screen = app.lesson_screen
        post = screen.post

        def hand_over(message: Message) -> None:
            if isinstance(message, RunController.Delivered):
                handed_over.append(message)
            post(message)

        monkeypatch.setattr(screen.runs, "_post", hand_over)
        logs = len(screen.runs.run.timeline.logs)
        batch: list[AnyEvent] = [Printed(ns(5) + number, "x", error=False) for number in range(3 * 256)]
        began = monotonic()
        await asyncio.to_thread(screen.runs.deliver, screen.runs.number, batch)
        assert monotonic() - began >= 3 * 0.05
        assert waits == [True] * 3
        assert len(screen.runs.run.timeline.logs) == logs + len(batch)


@pytest.mark.slow
async def test_a_session_may_deliver_a_long_batch_to_a_screen_that_is_gone() -> None:
    app = RecordedConsole("shared-group", shared_group_run().events, 5.0)
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        screen = app.lesson_screen
        await pilot.press("q")
        await until(pilot, lambda: not screen.is_attached)
        batch: list[AnyEvent] = [Printed(ns(5) + number, "x", error=False) for number in range(2 * 256)]
        # As on the session's own thread, which knows no app: asyncio.to_thread would hand it on.
        await asyncio.get_running_loop().run_in_executor(None, screen.runs.deliver, screen.runs.number, batch)
