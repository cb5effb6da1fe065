"""The lanes on screen: they draw what is set, survive any size, and send only what changed."""

from textual.app import App, ComposeResult
from textual.geometry import Region

from cbtui.looks.theme import Charset
from cbtui.widgets.lanes import Lanes
from sim.trace.model import Span, Window
from tests.support.builder import Run
from tests.support.runs import ns, shared_group_run
from tests.widgets.pictures import shared_group


class OneWidget(App[None]):
    def compose(self) -> ComposeResult:
        yield Lanes()


def lines_of(lanes: Lanes) -> list[str]:
    return [lanes.render_line(y).text for y in range(lanes.size.height)]


async def test_lanes_show_their_timeline_at_their_time() -> None:
    app = OneWidget()
    async with app.run_test(size=(80, 24)) as pilot:
        lanes = app.query_one(Lanes)
        lanes.timeline = shared_group(12.9)
        lanes.window, lanes.now = Window(ns(2.9), ns(12.9)), ns(12.9)
        await pilot.pause()
        assert lanes.size.height == 6
        assert "waits 8.9 s: A held by timer_callback" in lines_of(lanes)[2]
        assert lanes.border_title == "Lanes · 200 ms/col"
        assert lanes.picture is not None
        assert lanes.picture.scale.window.end == ns(13)


async def test_a_timeline_that_grew_is_painted_when_it_is_set_again() -> None:
    app = OneWidget()
    events = shared_group_run().events
    async with app.run_test(size=(80, 24)) as pilot:
        lanes = app.query_one(Lanes)
        lanes.timeline.extend(event for event in events if event.t < ns(1))
        lanes.timeline = lanes.timeline
        await pilot.pause()
        before = lines_of(lanes)
        lanes.timeline.extend(event for event in events if ns(1) <= event.t < ns(6))
        lanes.timeline = lanes.timeline
        await pilot.pause()
        assert lines_of(lanes) != before


async def test_what_came_since_the_timeline_was_set_does_not_make_now_a_past_moment() -> None:
    app = OneWidget()
    events = shared_group_run().events
    async with app.run_test(size=(80, 24)) as pilot:
        lanes = app.query_one(Lanes)
        lanes.timeline.extend(event for event in events if event.t < ns(5))
        lanes.window, lanes.now = Window(0, ns(10)), lanes.timeline.end
        lanes.timeline = lanes.timeline
        lanes.timeline.extend(event for event in events if ns(5) <= event.t < ns(6))
        await pilot.pause()
        assert "now▲" in lines_of(lanes)[-1]
        lanes.timeline = lanes.timeline
        await pilot.pause()
        assert "cursor▲" in lines_of(lanes)[-1]


async def test_a_call_that_begins_at_the_very_end_can_be_selected() -> None:
    run = Run()
    ring = run.timer(run.exclusive(run.node("/bell")), "ring", 0.1)
    run.start(ring, run.thread("Pool-0_0"), 0.1)
    app = OneWidget()
    async with app.run_test(size=(80, 24)) as pilot:
        lanes = app.query_one(Lanes)
        lanes.timeline.extend(run.events)
        lanes.window, lanes.now = Window(0, ns(0.2)), lanes.timeline.end
        lanes.timeline = lanes.timeline
        await pilot.pause()
        assert lanes.now == ns(0.1)
        selected = lanes.here()
        assert selected is not None
        assert isinstance(selected.bar, Span)


async def test_only_lines_that_changed_are_drawn_again() -> None:
    app = OneWidget()
    async with app.run_test(size=(80, 24)) as pilot:
        lanes = app.query_one(Lanes)
        lanes.timeline = shared_group()
        lanes.window, lanes.now = Window(0, ns(10)), ns(3.0)
        await pilot.pause()
        while lanes.picture is None or not lanes.picture.complete:
            await pilot.pause(0.05)
        drawn: list[Region] = []
        refresh = lanes.refresh

        def spy(*regions: Region, **options: bool) -> Lanes:
            drawn.extend(regions)
            return refresh(*regions, **options)

        lanes.refresh = spy  # type: ignore[method-assign]
        lanes.timeline = lanes.timeline
        await pilot.pause()
        assert drawn == []
        lanes.now = ns(3.001)
        await pilot.pause()
        assert len(drawn) < lanes.size.height


async def test_lanes_survive_any_size_and_charset() -> None:
    app = OneWidget()
    async with app.run_test(size=(80, 24)) as pilot:
        lanes = app.query_one(Lanes)
        lanes.timeline = shared_group()
        for width, height in ((140, 40), (1, 1), (20, 3), (80, 24)):
            await pilot.resize_terminal(width, height)
            await pilot.pause()
            assert all(len(line) == lanes.size.width for line in lines_of(lanes))
        lanes.charset = Charset.ASCII
        await pilot.pause()
        assert "".join(lines_of(lanes)).isascii()
