"""The guide: the text that is read stays in sight."""

import pytest
from textual.app import App, ComposeResult
from textual.pilot import Pilot

from cbtui.widgets.guide import Guide
from tests.support.pictures import lines_of

TEXT = "\n\n".join(
    f"Sentence {number} tells at some length what happens in the executor." for number in range(40)
)


class GuideOnly(App[None]):
    def compose(self) -> ComposeResult:
        yield Guide({"task": "A task.", "guide": TEXT})


async def resized(pilot: Pilot[None], width: int) -> list[str]:
    await pilot.resize_terminal(width, 10)
    for _ in range(5):
        await pilot.pause()
    return lines_of(pilot.app)


@pytest.mark.parametrize("width", [24, 60, 120])
async def test_after_a_resize_the_same_sentence_is_at_the_top(width: int) -> None:
    app = GuideOnly()
    async with app.run_test(size=(40, 10)) as pilot:
        app.query_one(Guide).scroll_to(y=49, animate=False)
        await pilot.pause()
        before = lines_of(app)[0].split()[:2]
        assert before[0] == "Sentence"
        assert (await resized(pilot, width))[0].split()[:2] == before
        assert (await resized(pilot, 40))[0].split()[:2] == before


async def test_what_comes_to_be_shown_while_the_sections_are_taken_away_does_no_harm() -> None:
    app = GuideOnly()
    async with app.run_test(size=(40, 10)):
        guide = app.query_one(Guide)
        await guide.remove_children()
        await guide.show({"task": "Another task."})
        guide.go_to("task")
        assert not guide.is_past("task")
