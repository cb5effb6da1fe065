import pytest
from textual.app import App, ComposeResult

import cbtui.widgets.log.lines as log_module
from cbtui.widgets.log import LogLines, line_of
from sim.trace.events import Logged, Printed, Severity
from sim.trace.timeline import Timeline
from tests.support.builder import Run, ns
from tests.support.pictures import lines_of


class LogOnly(App[None]):
    def compose(self) -> ComposeResult:
        yield LogLines()

    @property
    def view(self) -> LogLines:
        return self.query_one(LogLines)


def long_log(lines: int) -> Timeline:
    timeline = Timeline()
    timeline.extend(
        [Logged(number * 1_000_000, Severity.INFO, "n", f"line {number}", 0, 0) for number in range(lines)]
    )
    return timeline


def shown(app: App[None]) -> list[str]:
    """The lines on screen, without the scrollbar."""
    return [line.rstrip(" ▁▂▃▄▅▆▇█") for line in lines_of(app)]


def test_a_line_is_written_as_ros_prints_it() -> None:
    event = Logged(ns(9.301), Severity.INFO, "sub_node", "Odom CallBack", 1, 1)
    assert line_of(event) == "[INFO] [9.301] [sub_node]: Odom CallBack"


def test_printed_text_is_shown_as_it_is() -> None:
    assert line_of(Printed(0, "TICK", False)) == "TICK"


def test_control_characters_are_shown_and_not_obeyed() -> None:
    event = Logged(0, Severity.WARN, "n", "a\x1b[2Jb\rc\nd\x07\x9b", 0, 0)
    assert line_of(event) == "[WARN] [0.000] [n]: a␛[2Jb␍c␊d␇�"


async def test_the_log_stays_at_its_end() -> None:
    app = LogOnly()
    async with app.run_test(size=(60, 10)) as pilot:
        timeline = long_log(100)
        app.view.show(timeline, timeline.end)
        await pilot.pause()
        assert shown(app)[-1] == "[INFO] [0.099] [n]: line 99"
        timeline.extend([Logged(ns(1.0), Severity.INFO, "n", "one more", 0, 0)])
        app.view.show(timeline, timeline.end)
        await pilot.pause()
        assert shown(app)[-1] == "[INFO] [1.000] [n]: one more"


async def test_the_log_ends_at_the_moment_on_screen() -> None:
    app = LogOnly()
    async with app.run_test(size=(60, 10)) as pilot:
        app.view.show(long_log(100), 49_000_000)
        await pilot.pause()
        *_, last, mark = shown(app)
        assert last == "[INFO] [0.049] [n]: line 49"
        assert mark.startswith("─ 0.049 s, 50 later lines ─")


async def test_a_log_that_was_scrolled_away_from_its_end_stays_there() -> None:
    app = LogOnly()
    async with app.run_test(size=(60, 10)) as pilot:
        timeline = long_log(100)
        app.view.show(timeline, 50_000_000)
        await pilot.pause()
        app.view.scroll_to(y=5, animate=False, immediate=True)
        app.view.show(timeline, timeline.end)
        await pilot.pause()
        assert shown(app)[0] == "[INFO] [0.005] [n]: line 5"
        app.view.scroll_end(animate=False, immediate=True)
        timeline.extend([Logged(ns(1.0), Severity.INFO, "n", "one more", 0, 0)])
        app.view.show(timeline, timeline.end)
        await pilot.pause()
        assert shown(app)[-1] == "[INFO] [1.000] [n]: one more"


async def test_another_run_replaces_the_log() -> None:
    app = LogOnly()
    async with app.run_test(size=(60, 10)) as pilot:
        app.view.show(long_log(100), ns(1.0))
        await pilot.pause()
        app.view.show(long_log(3), ns(1.0))
        await pilot.pause()
        assert shown(app)[:4] == [
            "[INFO] [0.000] [n]: line 0",
            "[INFO] [0.001] [n]: line 1",
            "[INFO] [0.002] [n]: line 2",
            "",
        ]


@pytest.mark.parametrize(("width", "columns"), [(60, False), (90, True)])
async def test_a_wide_log_tells_thread_and_group(width: int, columns: bool) -> None:
    run = Run()
    thread = run.thread("ThreadPoolExecutor-0_1")
    timer = run.timer(run.exclusive(run.node("/n")), "tick", 1.0)
    run.log("Odom", 1.0, thread, timer)
    timeline = Timeline()
    timeline.extend(run.events)
    app = LogOnly()
    async with app.run_test(size=(width, 10)) as pilot:
        app.view.show(timeline, ns(2.0))
        await pilot.pause()
        assert shown(app)[0].endswith("Pool-0_1    A") is columns


async def test_a_long_name_of_a_thread_keeps_its_distance_from_the_group() -> None:
    run = Run()
    timer = run.timer(run.exclusive(run.node("/n")), "tick", 1.0)
    run.log("Odom", 1.0, run.thread("Thread-1 (spin)"), timer)
    timeline = Timeline()
    timeline.extend(run.events)
    app = LogOnly()
    async with app.run_test(size=(90, 10)) as pilot:
        app.view.show(timeline, ns(2.0))
        await pilot.pause()
        assert shown(app)[0].endswith("Thread-1 (… A")


async def test_only_the_lines_in_view_are_drawn(monkeypatch: pytest.MonkeyPatch) -> None:
    app = LogOnly()
    async with app.run_test(size=(60, 10)) as pilot:
        timeline = long_log(100_000)
        app.view.show(timeline, timeline.end)
        await pilot.pause()
        drawn: list[int] = []

        def counted(event: Logged | Printed) -> str:
            drawn.append(event.t)
            return line_of(event)

        monkeypatch.setattr(log_module, "line_of", counted)
        timeline.extend([Logged(timeline.end + 1, Severity.INFO, "n", "one more", 0, 0)])
        app.view.show(timeline, timeline.end)
        await pilot.pause()
        assert 10 <= len(drawn) <= 40
