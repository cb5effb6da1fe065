"""The lanes are as high as what they show, whatever is asked of them meanwhile."""

from textual.app import App, ComposeResult

from cbtui.widgets.lanes import Lanes
from sim.trace.timeline import Timeline
from tests.support.runs import shared_group_run


class _OnlyLanes(App[None]):
    def compose(self) -> ComposeResult:
        yield Lanes()


async def test_new_lanes_get_their_rows_though_it_was_asked_before_whether_all_are_shown() -> None:
    async with _OnlyLanes().run_test(size=(80, 24)) as pilot:
        lanes, timeline = pilot.app.query_one(Lanes), Timeline()
        lanes.timeline = timeline
        await pilot.pause()
        before = lanes.size.height
        timeline.extend(shared_group_run().events)
        assert not lanes.shows_everything
        lanes.timeline = timeline
        await pilot.pause()
        assert lanes.size.height > before
        assert lanes.shows_everything
