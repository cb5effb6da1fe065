"""Partial pictures are the same as whole ones, and only widgets with something new are asked to draw."""

import pytest
from textual._compositor import LayoutUpdate
from textual.app import App
from textual.strip import Strip
from textual.widget import Widget

from cbtui.terminal.compositing import PatchCompositor, PatchUpdate
from cbtui.widgets.guide import Guide
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


async def test_a_pane_without_news_is_not_asked_to_draw(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[type[Widget]] = []
    render_lines = Widget.render_lines

    def spy(widget: Widget, crop: object) -> list[Strip]:
        asked.append(type(widget))
        return render_lines(widget, crop)  # type: ignore[arg-type]

    app = RecordedConsole("shared-group", EVENTS, 2.0)
    async with app.run_test(size=WIDE) as pilot:
        monkeypatch.setattr(Widget, "render_lines", spy)
        await settle(pilot)
        while asked:  # on a busy machine some of the screen's beginning comes late
            asked.clear()
            await settle(pilot)
        app.lesson_screen.query_one("Lanes").refresh()
        await settle(pilot)
        assert asked
        assert Guide not in asked
