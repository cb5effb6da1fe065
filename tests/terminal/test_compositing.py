"""Partial pictures are the same as whole ones, and only widgets with something new are asked to draw."""

import math

import pytest
from textual._compositor import LayoutUpdate
from textual.app import App
from textual.geometry import Region, Size
from textual.screen import Screen
from textual.strip import Strip
from textual.widget import Widget

from cbtui.runs.compared_runs import ComparedSide
from cbtui.screens.compare import CompareScreen
from cbtui.terminal.compositing import PatchCompositor, PatchUpdate
from cbtui.widgets.guide import Guide
from cbtui.widgets.key_bar import KeyBar
from cbtui.widgets.lanes import Lanes
from cbtui.widgets.log import LogLines
from sim.trace.timeline import Timeline
from tests.support.builder import ns
from tests.support.console import NARROW, WIDE, RecordedConsole, settle
from tests.support.daily import first_daily
from tests.support.runs import shared_group_run

EVENTS = shared_group_run().events


Cell = tuple[str, object]


class Terminal:
    """What a terminal shows to which every update was sent: a character and its style for each cell."""

    def __init__(self) -> None:
        self.lines: list[list[Cell]] = []
        self.parts = 0

    def take(self, update: object) -> None:
        """Draw an update over what there was."""
        if isinstance(update, LayoutUpdate):
            assert update.region.offset == (0, 0)
            self.lines = [[cell for strip in line for cell in cells(strip)] for line in update.strips]
        elif isinstance(update, PatchUpdate):
            self.parts += 1
            for x, y, strip in update.parts:
                drawn = cells(strip)
                self.lines[y][x : x + len(drawn)] = drawn


def cells(strip: Strip) -> list[Cell]:
    return [(character, segment.style) for segment in strip for character in segment.text]


@pytest.mark.slow
@pytest.mark.parametrize("size", first_daily(WIDE, NARROW))
async def test_the_parts_that_are_sent_make_the_whole_picture(
    size: tuple[int, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    terminal = Terminal()
    app = RecordedConsole("shared-group", EVENTS, 2.0)
    async with app.run_test(size=size) as pilot:
        await settle(pilot)
        assert isinstance(app.screen._compositor, PatchCompositor)
        monkeypatch.setattr(App, "_display", lambda app, screen, update: terminal.take(update))
        app.screen.refresh(layout=True)
        await settle(pilot)

        def wrong() -> list[int]:
            whole = map(cells, app.screen._compositor.render_strips())
            return [y for y, pair in enumerate(zip(terminal.lines, whole, strict=True)) if pair[0] != pair[1]]

        for tenth in range(21, 61, 3):
            app.engines.latest.play(ns(tenth / 10))
            await settle(pilot)
            assert wrong() == []
        app.notify("something that lies over the panes")
        await settle(pilot)
        for key in ("enter", "down", "left_square_bracket", "left", "4", "2", "0"):
            await pilot.press(key)
            app.engines.latest.play(ns(7))
            await settle(pilot)
            assert wrong() == [], key
    assert terminal.parts > 4


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[type[Widget]]:
    """The kinds of widgets that were asked to draw."""
    kinds: list[type[Widget]] = []
    render_lines = Widget.render_lines

    def spy(widget: Widget, crop: object) -> list[Strip]:
        kinds.append(type(widget))
        return render_lines(widget, crop)  # type: ignore[arg-type]

    monkeypatch.setattr(Widget, "render_lines", spy)
    return kinds


async def test_a_pane_without_news_is_not_asked_to_draw(asked: list[type[Widget]]) -> None:
    app = RecordedConsole("shared-group", EVENTS, 2.0)
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        asked.clear()
        app.lesson_screen.query_one("Lanes").refresh()
        await settle(pilot)
        assert asked
        assert Guide not in asked


async def test_a_comparison_that_goes_on_sends_parts_and_is_not_laid_out_anew(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    first, second = Timeline(), Timeline()
    first.extend(EVENTS)
    second.extend([each for each in EVENTS if each.t <= ns(12)])
    laid_out: list[Screen[None]] = []
    terminal, keys = Terminal(), list[KeyBar]()
    app = RecordedConsole("shared-group", EVENTS, 2.0)
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        sides = ComparedSide("one", first), ComparedSide("two", second, alive=lambda: True)
        screen = CompareScreen(*sides, app.charset)
        await app.push_screen(screen)
        await app.workers.wait_for_complete()
        await pilot.pause()
        monkeypatch.setattr(App, "_display", lambda app, screen, update: terminal.take(update))
        screen.refresh(layout=True)
        await pilot.pause()
        monkeypatch.setattr(screen, "_refresh_layout", lambda *_, **__: laid_out.append(screen))
        monkeypatch.setattr(KeyBar, "rows", lambda bar, _: keys.append(bar) or bar._rows)  # type: ignore[func-returns-value]
        screen._rest_until = math.inf  # no figures, which come with the keys
        for tenth in range(121, 150, 3):
            second.extend([each for each in EVENTS if ns((tenth - 3) / 10) < each.t <= ns(tenth / 10)])
            screen.draw()
            await pilot.pause()
            whole = list(map(cells, screen._compositor.render_strips()))
            assert terminal.lines == whole
    assert terminal.parts > 4
    assert not laid_out
    assert not keys


async def test_lines_between_those_with_news_are_not_drawn(monkeypatch: pytest.MonkeyPatch) -> None:
    drawn: list[int] = []
    render_lines = Lanes.render_lines

    def spy(lanes: Lanes, crop: Region) -> list[Strip]:
        drawn.extend(crop.line_range)
        return render_lines(lanes, crop)

    monkeypatch.setattr(Lanes, "render_lines", spy)
    app = RecordedConsole("shared-group", EVENTS, 2.0)
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        drawn.clear()
        lanes = app.lesson_screen.query_one(Lanes)
        lanes.refresh(Region(0, 0, 5, 2), Region(0, 4, 5, 1))
        await settle(pilot)
        top = lanes.gutter.top
        assert drawn == [top, top + 1, top + 4]


async def test_no_pane_is_asked_to_draw_by_a_screen_that_it_hides(asked: list[type[Widget]]) -> None:
    app = RecordedConsole("shared-group", EVENTS, 2.0)
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        asked.clear()
        menu, lesson = app.screen_stack
        assert lesson is app.lesson_screen
        menu.refresh()
        for child in menu.children:
            child.refresh()
        await settle(pilot)
        assert Guide not in asked
        await pilot.press("question_mark")
        lesson.refresh()
        asked.clear()
        await settle(pilot)
        assert Guide in asked  # the help lies over it and lets it through


@pytest.fixture
def looked_at(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let every layout be looked at before it is made, as Textual does now and then."""
    makes = Screen._refresh_layout

    def looks_and_makes(screen: Screen[None], size: Size | None = None, scroll: bool = False) -> None:
        if isinstance(screen._compositor, PatchCompositor):
            screen._compositor._full_map_invalidated = True
            screen._compositor.full_map  # noqa: B018 a property that arranges the widgets
        makes(screen, size, scroll)

    monkeypatch.setattr(Screen, "_refresh_layout", looks_and_makes)


@pytest.mark.usefixtures("looked_at")
async def test_a_widget_hears_of_its_new_size_although_the_new_layout_was_looked_at_before() -> None:
    app = RecordedConsole("shared-group", EVENTS, 2.0)
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        log = app.screen.query_one(LogLines)
        assert log.scroll_offset.y == log.max_scroll_y > 0
        height = log.size.height
        app.screen.query_one(Lanes).styles.height = 16
        await settle(pilot)
        assert log.size.height < height
        assert log.scroll_offset.y == log.max_scroll_y


@pytest.mark.usefixtures("looked_at")
async def test_a_pane_that_takes_the_place_of_another_counts_as_shown_and_is_drawn(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    terminal, shown = Terminal(), list[Widget]()
    app = RecordedConsole("shared-group", EVENTS, 2.0)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        monkeypatch.setattr(App, "_display", lambda app, screen, update: terminal.take(update))
        monkeypatch.setattr(Widget, "_on_show", lambda widget, event: shown.append(widget))
        app.screen.refresh(layout=True)
        await settle(pilot)
        for key, pane in (("4", "robot"), ("5", "log"), ("4", "robot")):
            shown.clear()
            await pilot.press(key)
            await settle(pilot)
            assert app.screen.query_one(f"#{pane}") in shown
            assert terminal.lines == list(map(cells, app.screen._compositor.render_strips()))
