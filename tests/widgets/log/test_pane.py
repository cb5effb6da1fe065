import pytest
from textual.app import App, ComposeResult
from textual.pilot import Pilot
from textual.strip import Strip

import cbtui.widgets.log.lines as lines_module
from cbtui.widgets.log import LogFilter, LogLines, LogView
from cbtui.widgets.log.filter import LogEvent
from cbtui.widgets.log.line import width_of
from sim.quantities.durations import timestamp
from sim.trace.events import Logged, Severity
from sim.trace.timeline import Timeline
from tests.support.builder import Run, ns
from tests.support.pictures import lines_of


class PaneOnly(App[None]):
    def __init__(self) -> None:
        super().__init__()
        self.moments: list[int | None] = []

    def compose(self) -> ComposeResult:
        yield LogView()

    @property
    def pane(self) -> LogView:
        return self.query_one(LogView)

    def on_inked_view_moment_picked(self, message: LogLines.MomentPicked) -> None:
        self.moments.append(message.at)


def log_of(count: int) -> Timeline:
    """A line every millisecond, every tenth of them a warning."""
    timeline = Timeline()
    timeline.extend(
        Logged(n * 1_000_000, Severity.WARN if n % 10 == 0 else Severity.INFO, "n", f"line {n}", 0, 0)
        for n in range(count)
    )
    return timeline


def shown(app: App[None]) -> list[str]:
    return [line.strip(" ▁▂▃▄▅▆▇█") for line in lines_of(app)]


def texts(app: App[None]) -> list[str]:
    return [line.partition("]: ")[2] for line in shown(app) if "]: " in line]


async def typed(pilot: Pilot[None], text: str) -> None:
    pilot.app.query_one(LogView).focus_filter()
    await pilot.pause()
    pilot.app.query_one(LogFilter).value = text
    await pilot.pause()
    await pilot.pause()


async def test_a_filter_that_no_line_passes_says_so_and_how_to_see_all_again() -> None:
    async with PaneOnly().run_test(size=(80, 8)) as pilot:
        await showing(pilot, log_of(30), ns(0.01))
        await typed(pilot, "zzz")
        assert "nothing so far matches zzz; esc shows all" in shown(pilot.app)
        await typed(pilot, "line 20")
        assert "nothing so far matches line 20; esc shows all" in shown(pilot.app), (
            "it is one of the later lines"
        )
        await typed(pilot, "line 5")
        assert not any("nothing so far" in line for line in shown(pilot.app))
        await pilot.press("escape")
        await pilot.pause()
        assert "line 5" in texts(pilot.app)


async def showing(pilot: Pilot[None], timeline: Timeline, now: int | None = None) -> None:
    pilot.app.query_one(LogView).show(timeline, timeline.end if now is None else now)
    pilot.app.query_one(LogLines).focus()
    await pilot.pause()


async def test_the_pane_says_how_many_lines_there_are_and_that_it_follows() -> None:
    app = PaneOnly()
    async with app.run_test(size=(60, 10)) as pilot:
        await showing(pilot, log_of(1))
        assert app.pane.note == "1 line · follows"
        await showing(pilot, log_of(4310))
        assert app.pane.note == "4,310 lines · follows"


async def test_a_filter_shows_the_lines_that_it_lets_through_and_how_many() -> None:
    app = PaneOnly()
    async with app.run_test(size=(60, 10)) as pilot:
        await showing(pilot, log_of(50))
        await typed(pilot, "level:warn")
        assert texts(app) == ["line 0", "line 10", "line 20", "line 30", "line 40"]
        assert shown(app)[-1] == "level:warn"
        assert app.pane.note == "5 of 50 lines · follows"


async def test_lines_that_come_pass_the_filter_too() -> None:
    app = PaneOnly()
    async with app.run_test(size=(60, 10)) as pilot:
        timeline = log_of(10)
        await showing(pilot, timeline)
        await typed(pilot, "level:warn")
        timeline.extend([Logged(ns(1), Severity.ERROR, "n", "worse", 0, 0)])
        timeline.extend([Logged(ns(2), Severity.INFO, "n", "nothing", 0, 0)])
        app.pane.show(timeline, timeline.end)
        await pilot.pause()
        assert texts(app) == ["line 0", "worse"]
        assert app.pane.note == "2 of 12 lines · follows"


async def test_a_filtered_log_ends_at_the_moment_on_screen() -> None:
    app = PaneOnly()
    async with app.run_test(size=(60, 10)) as pilot:
        await showing(pilot, log_of(50), 25_000_000)
        await typed(pilot, "level:warn")
        assert texts(app) == ["line 0", "line 10", "line 20"]
        assert app.pane.note == "3 of 26 lines · follows"


async def test_a_long_log_is_searched_to_its_end_by_and_by(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lines_module, "_SEARCH_BATCH", 10)
    app = PaneOnly()
    async with app.run_test(size=(60, 10)) as pilot:
        await showing(pilot, log_of(500))
        await typed(pilot, "level:warn")
        while app.pane.note != "50 of 500 lines · follows":
            await pilot.pause()
        assert texts(app)[-1] == "line 490"


async def test_escape_clears_the_filter_and_enter_keeps_it() -> None:
    app = PaneOnly()
    async with app.run_test(size=(60, 10)) as pilot:
        await showing(pilot, log_of(50))
        await typed(pilot, "level:warn")
        await pilot.press("enter")
        assert app.query_one(LogLines).has_focus
        assert shown(app)[-1] == "level:warn"
        await typed(pilot, "")
        await pilot.press("escape")
        await pilot.pause()
        assert app.query_one(LogLines).has_focus
        assert texts(app)[-1] == "line 49"
        assert not app.query_one(LogFilter).display
        assert app.pane.note == "50 lines · follows"


async def test_a_filter_that_means_nothing_is_told_of_and_keeps_no_line_back() -> None:
    app = PaneOnly()
    async with app.run_test(size=(80, 10)) as pilot:
        await showing(pilot, log_of(50))
        await typed(pilot, "level:loud")
        assert shown(app)[-2:] == ["level: wants one of debug, info, warn, error, fatal", "level:loud"]
        assert texts(app)[-1] == "line 49"
        app.query_one(LogFilter).value = "level:warn"
        await pilot.pause()
        assert "wants" not in "".join(shown(app))


async def test_another_run_is_filtered_as_the_one_before() -> None:
    app = PaneOnly()
    async with app.run_test(size=(60, 10)) as pilot:
        await showing(pilot, log_of(50))
        await typed(pilot, "level:warn")
        await showing(pilot, log_of(15))
        assert texts(app) == ["line 0", "line 10"]


async def test_a_log_that_stays_shows_the_same_stretch_when_the_filter_goes() -> None:
    app = PaneOnly()
    async with app.run_test(size=(60, 10)) as pilot:
        await showing(pilot, log_of(500))
        await typed(pilot, "level:warn")
        await pilot.press("enter", "f")
        app.query_one(LogLines).scroll_to(y=20, animate=False, immediate=True)
        await pilot.pause()
        assert texts(app)[0] == "line 200"
        await typed(pilot, "")
        await pilot.press("escape")
        await pilot.pause()
        assert texts(app)[0] == "line 200"
        assert app.pane.note.endswith("stays")


async def test_f_stays_and_follows_again() -> None:
    app = PaneOnly()
    async with app.run_test(size=(60, 10)) as pilot:
        timeline = log_of(100)
        await showing(pilot, timeline)
        await pilot.press("f")
        assert app.pane.note == "100 lines · stays"
        timeline.extend([Logged(ns(1), Severity.INFO, "n", "one more", 0, 0)])
        await showing(pilot, timeline)
        assert texts(app)[-1] == "line 99"
        await pilot.press("f")
        await pilot.pause()
        assert texts(app)[-1] == "one more"
        assert app.pane.note == "101 lines · follows"


async def test_looking_back_does_not_make_a_log_follow_that_stays() -> None:
    app = PaneOnly()
    async with app.run_test(size=(60, 10)) as pilot:
        timeline = log_of(100)
        await showing(pilot, timeline)
        await pilot.press("f")
        await showing(pilot, timeline, 50_000_000)
        assert app.pane.note == "51 lines · stays"


async def test_a_log_follows_again_once_the_picked_line_is_let_go() -> None:
    app = PaneOnly()
    async with app.run_test(size=(60, 10)) as pilot:
        timeline = log_of(100)
        await showing(pilot, timeline)
        await typed(pilot, "line 1")
        await pilot.press("enter", "up", "up", "escape", "escape")
        await showing(pilot, timeline, 50_000_000)
        assert app.pane.note == "51 lines · follows"
        await pilot.press("up")
        await showing(pilot, timeline, 20_000_000)
        assert app.pane.note == "21 lines · follows", "the picked line came later than the moment"
        await pilot.press("f", "up", "escape")
        assert app.pane.note == "21 lines · stays"


async def test_enter_tells_the_time_of_the_line_that_was_picked_with_the_arrows() -> None:
    app = PaneOnly()
    async with app.run_test(size=(60, 10)) as pilot:
        await showing(pilot, log_of(100))
        await pilot.press("enter")
        assert app.moments == []
        await pilot.press("up", "up", "up", "down", "enter")
        assert app.moments == [98_000_000]
        assert app.pane.note == "100 lines · stays"


async def test_the_picked_line_comes_into_view() -> None:
    app = PaneOnly()
    async with app.run_test(size=(60, 10)) as pilot:
        await showing(pilot, log_of(100))
        await pilot.press(*["up"] * 15)
        await pilot.pause()
        assert texts(app)[0] == "line 85"
        await pilot.press(*["down"] * 12)
        await pilot.pause()
        assert texts(app)[-1] == "line 97"


async def test_a_click_on_a_line_tells_its_time_under_a_filter_too() -> None:
    app = PaneOnly()
    async with app.run_test(size=(60, 10)) as pilot:
        await showing(pilot, log_of(100))
        await typed(pilot, "level:warn")
        await pilot.click(LogLines, offset=(5, 3))
        assert app.moments == [30_000_000 + 10_000_000]
        assert texts(app)[3] == "line 40"


async def test_a_click_below_the_last_line_tells_nothing() -> None:
    app = PaneOnly()
    async with app.run_test(size=(60, 10)) as pilot:
        await showing(pilot, log_of(3))
        await pilot.click(LogLines, offset=(5, 7))
        assert app.moments == []


async def test_what_is_copied_is_what_is_in_view_or_the_picked_line() -> None:
    app = PaneOnly()
    async with app.run_test(size=(30, 4)) as pilot:
        await showing(pilot, log_of(100))
        await pilot.press("y")
        assert app.clipboard.splitlines()[-1] == "[INFO] [0.099] [n]: line 99"
        assert len(app.clipboard.splitlines()) == 4
        await pilot.press("up", "y")
        assert app.clipboard == "[INFO] [0.099] [n]: line 99"


async def test_a_picked_line_that_the_filter_keeps_back_is_let_go() -> None:
    app = PaneOnly()
    async with app.run_test(size=(60, 10)) as pilot:
        await showing(pilot, log_of(100))
        await pilot.press("up")
        await typed(pilot, "level:warn")
        assert app.query_one(LogLines).picked is None


async def test_whoever_looks_back_reads_how_many_lines_came_later() -> None:
    app = PaneOnly()
    async with app.run_test(size=(60, 10)) as pilot:
        lines = app.query_one(LogLines)
        await showing(pilot, log_of(100), 50_000_000)
        assert "[n]: line 50" in lines.render_line(8).text
        assert lines.render_line(9).text.startswith("─ 0.050 s, 49 later lines ───")
        await showing(pilot, log_of(100), 98_000_000)
        assert lines.render_line(9).text.startswith("─ 0.098 s, 1 later line ───")
        await typed(pilot, "99")
        assert lines.render_line(0).text.startswith("─ 0.098 s, 1 later line ───")
        await showing(pilot, log_of(100))
        assert "later" not in "".join(lines.render_line(y).text for y in range(9))


async def test_the_moment_above_the_later_lines_goes_on_with_the_time(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    drawn: list[str] = []
    draw = LogLines.render_line

    def watched(lines: LogLines, y: int) -> Strip:
        drawn.append(draw(lines, y).text)
        return draw(lines, y)

    monkeypatch.setattr(LogLines, "render_line", watched)
    app = PaneOnly()
    async with app.run_test(size=(60, 10)) as pilot:
        log = log_of(100)
        await showing(pilot, log, 50_000_000)
        for now in range(50_100_000, 51_000_000, 200_000):
            await pilot.pause(0.1)
            app.query_one(LogView).show(log, now)
            await pilot.pause(0.1)
            assert drawn[-1].startswith(f"─ {timestamp(now)}, ")


async def test_the_line_of_the_moment_is_set_off_while_looking_back() -> None:
    app = PaneOnly()
    async with app.run_test(size=(60, 10)) as pilot:
        lines = app.query_one(LogLines)
        await showing(pilot, log_of(100))
        plain = lines.render_line(8)
        assert [segment.style for segment in lines.render_line(9)] == [segment.style for segment in plain]
        app.stylesheet.add_source(".log--moment { background: red; }")
        app.refresh_css()
        await showing(pilot, log_of(100), 50_000_000)
        ground = [segment.style.bgcolor for segment in lines.render_line(8) if segment.style]
        assert {colour.name for colour in ground if colour} == {"#ff0000"}


async def test_a_long_line_takes_the_room_of_thread_and_group_and_is_cut_off_at_the_edge() -> None:
    run = Run()
    thread = run.thread("MainThread")
    timer = run.timer(run.exclusive(run.node("/n")), "tick", 1.0)
    for text in ("short", "x" * 50, "x" * 80):
        run.log(text, 1.0, thread, timer)
    timeline = Timeline()
    timeline.extend(run.events)
    app = PaneOnly()
    async with app.run_test(size=(80, 5)) as pilot:
        await showing(pilot, timeline)
        short, long, longest, *_ = shown(app)
        head = short.partition("short")[0]
        assert short == f"{head}short".ljust(65) + "MainThread  A"
        assert long == f"{head}{'x' * 50}"
        assert longest == f"{head}{'x' * 80}"[:79] + "…"


async def test_the_pane_is_as_wide_as_the_widest_line_that_was_in_view_and_measures_no_other(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    measured: list[LogEvent] = []

    def measure(event: LogEvent) -> int:
        measured.append(event)
        return width_of(event)

    monkeypatch.setattr(lines_module, "width_of", measure)
    app = PaneOnly()
    async with app.run_test(size=(30, 10)) as pilot:
        lines = app.query_one(LogLines)
        timeline = log_of(5000)
        timeline.extend([Logged(ns(5), Severity.INFO, "n", "漢字" * 30, 0, 0)])
        timeline.extend([Logged(ns(6), Severity.INFO, "n", f"line {n}", 0, 0) for n in range(100)])
        await showing(pilot, timeline)
        assert lines.virtual_size.width == len("[INFO] [6.000] [n]: line 99")
        assert len(measured) <= 20
        lines.scroll_to(y=4995, animate=False, immediate=True)
        await pilot.pause()
        assert lines.virtual_size.width == len("[INFO] [5.000] [n]: ") + 120
        await typed(pilot, "line")
        assert lines.virtual_size.width < 30


async def test_a_picked_line_that_is_too_long_is_unfolded_below() -> None:
    timeline = Timeline()
    long = " ".join(f"word{number}" for number in range(12))
    timeline.extend(Logged(n, Severity.INFO, "n", text, 0, 0) for n, text in enumerate(("short", long)))
    app = PaneOnly()
    async with app.run_test(size=(60, 12)) as pilot:
        await showing(pilot, timeline)
        app.query_one("#unfolded").styles.width = "100%"
        seen = ["word11" in " ".join(shown(app))]
        for _ in range(2):
            await pilot.press("up")
            await pilot.pause()
            seen.append("word11" in " ".join(shown(app)))
        assert seen == [False, True, False]
