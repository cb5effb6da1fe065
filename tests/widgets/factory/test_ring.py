"""The ring of a deadlock, below the factory: whole, however narrow that is."""

import pytest
from textual.app import App, ComposeResult

from cbtui.widgets.factory import FactoryView
from sim.trace.timeline import Timeline
from tests.support.pictures import text_of
from tests.widgets.pictures import split_groups

RING = ("timer_callback", "/a_service_with_a_long_name", "group A", "another_callback", "timer_callback")


class OneWidget(App[None]):
    def compose(self) -> ComposeResult:
        yield FactoryView()


@pytest.mark.parametrize("size", [(78, 12), (46, 12), (140, 20)])
async def test_the_factory_tells_who_waits_for_whom_in_whole_words(size: tuple[int, int]) -> None:
    app = OneWidget()
    async with app.run_test(size=size) as pilot:
        factory, timeline = app.query_one(FactoryView), split_groups(9.4)
        factory.show(timeline, timeline.end, 1.0, RING)
        await pilot.pause()
        words = " ".join(text_of(app).split())
        assert f"deadlock: {' → '.join(RING)}" in words
        assert factory.note == "deadlock"
        factory.show(timeline, timeline.end, 1.0)
        await pilot.pause()
        assert "deadlock" not in text_of(app)
        assert factory.note == ""


async def test_before_anything_has_happened_there_is_no_ring() -> None:
    app = OneWidget()
    async with app.run_test(size=(30, 4)) as pilot:
        app.query_one(FactoryView).show(Timeline(), 0, 1.0)
        await pilot.pause()
        assert "deadlock" not in text_of(app)
