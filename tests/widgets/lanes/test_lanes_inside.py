"""The second row of a thread, and the overview of the whole run, where there is room."""

from textual.app import App, ComposeResult

from cbtui.looks.theme import Charset
from cbtui.widgets.lanes import LanePainter, Lanes, wanted_rows
from cbtui.widgets.lanes.rows import ThreadLane
from sim.trace.events import CallbackAt, Doing
from sim.trace.model import Window
from sim.trace.timeline import Timeline
from tests.support.runs import Run, ns
from tests.widgets.pictures import last, plain, shared_group

WIDTH = 130
FRAMES = (("node.py", "outer", 12),)


def busy_run() -> Timeline:
    """A callback that sleeps, and spins another one inside itself."""
    run = Run()
    thread = run.thread("MainThread")
    node = run.node("/n")
    outer, inner = run.timer(run.exclusive(node), "outer", 1.0), run.timer(run.exclusive(node), "inner", 1.0)
    run.callback(outer, thread, 1.0, 8.0)
    run.callback(inner, thread, 6.0, 2.0)
    sleeps = CallbackAt(ns(1.1), outer, thread, Doing.SLEEPS, "time.sleep", FRAMES)
    spins = CallbackAt(ns(5.0), outer, thread, Doing.CALLS_ROS, "spin_once", FRAMES)
    timeline = Timeline()
    timeline.extend(sorted([*run.until(10.0), sleeps, spins], key=lambda event: event.t))
    return timeline


def test_further_rows_of_a_thread_tell_what_its_call_does_and_what_runs_inside_it() -> None:
    timeline = busy_run()
    height = wanted_rows(timeline, width=WIDTH, window=Window(0, ns(10)))
    picture = LanePainter().paint(timeline, *last(10, 10.0), WIDTH, height)
    first, second, third, *_ = plain(picture.rows).splitlines()
    assert "A outer" in first
    assert "sleeps, line 12" in second
    assert "in spin_once()" in second[second.index("sleeps") :]
    assert third.index("inner") > second.index("sleeps")
    assert [isinstance(lane, ThreadLane) for lane in picture.lanes[:4]] == [True, True, True, False]
    one_less = LanePainter().paint(timeline, *last(10, 10.0), WIDTH, height - 1)
    second = plain(one_less.rows).splitlines()[1]
    assert second.index("sleeps, line 12") < second.index("inner")
    assert "." in plain(LanePainter(Charset.ASCII).paint(timeline, *last(10, 10.0), WIDTH, height).rows)


def test_a_second_row_takes_no_room_from_lanes() -> None:
    timeline = busy_run()
    every = wanted_rows(timeline)
    for width, height in ((WIDTH, every), (80, every + 5)):
        picture = LanePainter().paint(timeline, *last(10, 10.0), width, height)
        assert len(set(picture.lanes)) == len(picture.lanes) == every - 1


def test_the_overview_shows_the_whole_run_once_a_part_is_on_screen() -> None:
    timeline = shared_group(14.0)
    assert wanted_rows(timeline, width=WIDTH, window=Window(0, ns(20))) == wanted_rows(timeline)
    window = Window(ns(4), ns(14))
    height = wanted_rows(timeline, width=WIDTH, window=window)
    picture = LanePainter().paint(timeline, window, ns(14), WIDTH, height)
    row = plain(picture.rows).splitlines()[-1]
    assert row.startswith("whole run")
    assert picture.overview is not None
    busy = row.split("│")[1]
    assert busy[picture.overview.column_of(ns(1))] < busy[picture.overview.column_of(ns(8))] == "█"
    inks = [run.ink for run in picture.rows[-1] if "█" in run.text]
    assert not any(ink.later for ink in inks)


class OneWidget(App[None]):
    picked: Lanes.BarPicked | None = None

    def compose(self) -> ComposeResult:
        yield Lanes()

    def on_lanes_bar_picked(self, message: Lanes.BarPicked) -> None:
        self.picked = message


async def test_a_click_on_the_overview_goes_there() -> None:
    app = OneWidget()
    async with app.run_test(size=(WIDTH, 24)) as pilot:
        lanes = app.query_one(Lanes)
        lanes.window, lanes.now = Window(ns(4), ns(14)), ns(14)
        lanes.timeline = shared_group(14.0)
        await pilot.pause()
        picture = lanes.picture
        assert picture is not None
        assert picture.overview is not None
        place = picture.layout.names + 1 + picture.overview.column_of(ns(2.0))
        await pilot.click(Lanes, offset=(place, len(picture.rows) - 1))
        assert app.picked is not None
        assert abs(app.picked.at - ns(2.0)) <= picture.overview.per_column
        assert app.picked.selection is None
