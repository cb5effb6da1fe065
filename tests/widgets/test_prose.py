from pathlib import Path

from textual.app import App, ComposeResult

import cbtui.app
from cbtui.widgets.prose import Prose

TEXT = """# One seat

Who *waits* presses `s`.

## Why

- the first
- the second, which is so long that it goes on in another line

| threads | ticks |
|---------|-------|
| 1       | late  |
"""


class Page(App[None]):
    CSS_PATH = Path(cbtui.app.__file__).with_name("app.tcss")

    def compose(self) -> ComposeResult:
        yield Prose(TEXT)


def shown(app: App[None]) -> list[str]:
    strips = app.screen._compositor.render_strips()
    return ["".join(segment.text for segment in strip).rstrip() for strip in strips]


async def test_headings_paragraphs_lists_and_tables_are_laid_out() -> None:
    app = Page()
    async with app.run_test(size=(40, 20)):
        prose = app.query_one(Prose)
        assert shown(app)[: prose.size.height] == [
            "One seat",
            "",
            "Who waits presses s.",
            "",
            "Why",
            "",
            " • the first",
            " • the second, which is so long that it",
            "   goes on in another line",
            "",
            "",
            " threads  ticks",
            " ──────────────",
            " 1        late",
            "",
        ]


async def test_another_text_takes_the_room_that_it_needs() -> None:
    app = Page()
    async with app.run_test(size=(40, 20)) as pilot:
        app.query_one(Prose).text = "One line."
        await pilot.pause()
        assert app.query_one(Prose).size.height == 1


async def test_headings_and_keys_follow_the_theme() -> None:
    app = Page()
    async with app.run_test(size=(40, 20)) as pilot:
        before = colour_of(app, "One seat")
        app.theme = "textual-light"
        await pilot.pause()
        assert colour_of(app, "One seat") not in (None, before)
        assert colour_of(app, "s") not in (None, colour_of(app, "Who "))


def colour_of(app: App[None], text: str) -> object:
    for strip in app.screen._compositor.render_strips():
        for part, style, _ in strip:
            if part == text and style is not None:
                return style.color
    return None
