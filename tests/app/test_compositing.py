"""Partial pictures are the same as whole ones, and only widgets with something new are asked to draw."""

import pytest
from textual._compositor import ChopsUpdate
from textual.app import App
from textual.screen import Screen
from textual.strip import Strip
from textual.widget import Widget

from cbtui.compositing import SparingCompositor
from cbtui.widgets.guide import Guide
from tests.support.builder import ns
from tests.support.console import NARROW, WIDE, RecordedConsole, settle
from tests.support.runs import shared_group_run

EVENTS = shared_group_run().events


def wrong_parts(screen: Screen[None], update: ChopsUpdate) -> list[tuple[int, int, int]]:
    """The stretches of lines in which an update differs from the whole picture."""
    whole = screen._compositor.render_strips()
    wrong = []
    for y, left, right in update.spans:
        for end, (start, strip) in zip(update.chop_ends[y], update.chops[y].items(), strict=True):
            inside = start < right and end > left
            if inside and (strip is None or plain(strip) != plain(whole[y].crop(start, end))):
                wrong.append((y, start, end))
    return wrong


def plain(strip: Strip) -> list[tuple[str, object]]:
    return [(character, segment.style) for segment in strip for character in segment.text]


@pytest.mark.parametrize("size", [NARROW, WIDE])
async def test_partial_pictures_are_parts_of_the_whole(
    size: tuple[int, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    updates = 0
    wrong: list[tuple[int, int, int]] = []

    def display(app: App[None], screen: Screen[None], update: object) -> None:
        nonlocal updates
        if isinstance(update, ChopsUpdate):
            updates += 1
            wrong.extend(wrong_parts(screen, update))

    app = RecordedConsole("shared-group", EVENTS, 2.0)
    async with app.run_test(size=size) as pilot:
        await settle(pilot)
        assert isinstance(app.screen._compositor, SparingCompositor)
        monkeypatch.setattr(App, "_display", display)
        for tenth in range(21, 61, 3):
            app.engines.latest.play(ns(tenth / 10))
            await settle(pilot)
        app.notify("something that lies over the panes")
        await settle(pilot)
        for key in ("enter", "down", "left_square_bracket", "left", "4", "2", "0"):
            await pilot.press(key)
            app.engines.latest.play(ns(7))
            await settle(pilot)
    assert updates > 4
    assert wrong == []


async def test_a_pane_without_news_is_not_asked_to_draw(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[type[Widget]] = []
    render_lines = Widget.render_lines

    def spy(widget: Widget, crop: object) -> list[Strip]:
        asked.append(type(widget))
        return render_lines(widget, crop)  # type: ignore[arg-type]

    app = RecordedConsole("shared-group", EVENTS, 2.0)
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        await pilot.pause(0.5)  # The guide's Markdown is laid out some time after the rest.
        monkeypatch.setattr(Widget, "render_lines", spy)
        app.lesson_screen.query_one("Lanes").refresh()
        await settle(pilot)
        assert asked
        assert Guide not in asked
