"""The sizes of panes: what the keys change, what is offered, and that a next console finds them."""

import pytest
from textual.pilot import Pilot

from cbtui.widgets.lanes import Lanes
from lessons.personal import state_folder
from tests.support.console import NARROW, WIDE, RecordedConsole, settle
from tests.support.pictures import text_of
from tests.support.runs import shared_group_run, split_groups_run

EVENTS = shared_group_run().events


def width(app: RecordedConsole, pane: str) -> int:
    return app.lesson_screen.query_one(f"#{pane}").outer_size.width


def height(app: RecordedConsole, pane: str) -> int:
    return app.lesson_screen.query_one(f"#{pane}").outer_size.height


async def press(pilot: Pilot[None], *keys: str) -> None:
    for key in keys:
        await pilot.press(key)
        await settle(pilot)


@pytest.mark.slow
async def test_a_pane_takes_room_from_its_neighbours_which_a_next_console_finds() -> None:
    app = RecordedConsole("split-groups", split_groups_run().events, 9.4)
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        await press(pilot, "2")
        before = {pane: (width(app, pane), height(app, pane)) for pane in ("guide", "code", "robot", "log")}
        await press(pilot, "ctrl+right", "ctrl+up", "5", "ctrl+left")
        changed = {pane: (width(app, pane), height(app, pane)) for pane in before}
        assert changed["guide"][0] == before["guide"][0]
        assert changed["code"][0] > before["code"][0]
        assert changed["robot"][0] < before["robot"][0]
        assert changed["log"][0] < before["log"][0]
        assert changed["code"][1] > before["code"][1]
        assert changed["log"][1] < before["log"][1]
    again = RecordedConsole("split-groups", split_groups_run().events, 9.4)
    async with again.run_test(size=WIDE) as pilot:
        await settle(pilot)
        assert {pane: (width(again, pane), height(again, pane)) for pane in before} == changed
        await press(pilot, "2", "equals_sign")
        assert {pane: (width(again, pane), height(again, pane)) for pane in before} == before


async def test_the_code_has_more_room_while_it_is_read_unless_the_user_gave_other_sizes() -> None:
    app = RecordedConsole("shared-group", EVENTS, 12.9)
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        usual = width(app, "guide"), width(app, "code"), width(app, "robot")
        await press(pilot, "2")
        assert width(app, "code") >= 75
        assert app.lesson_screen.check_action("usual_sizes", ()) is False
        await press(pilot, "1")
        assert usual == (width(app, "guide"), width(app, "code"), width(app, "robot"))
        await press(pilot, "ctrl+right", "2")
        assert width(app, "guide") > usual[0]
        assert width(app, "code") < usual[1]


async def test_a_scene_keeps_the_columns_of_its_words_while_the_code_is_read() -> None:
    app = RecordedConsole("stale-data", EVENTS, 12.9)
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        await press(pilot, "2")
        assert width(app, "robot") >= 34
        assert width(app, "code") >= 70


@pytest.mark.parametrize(("lesson", "columns", "least"), [("stale-data", 160, 60), ("shared-group", 200, 88)])
async def test_on_a_wide_screen_the_code_has_the_columns_that_the_scene_can_spare(
    lesson: str, columns: int, least: int
) -> None:
    app = RecordedConsole(lesson, EVENTS, 12.9)
    async with app.run_test(size=(columns, 55)) as pilot:
        await settle(pilot)
        assert width(app, "code") >= least
        assert 34 <= width(app, "robot") < width(app, "guide") < width(app, "code")


async def test_rows_go_between_lanes_and_pane_on_a_small_screen() -> None:
    app = RecordedConsole("shared-group", EVENTS, 12.9)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        lanes = app.lesson_screen.query_one(Lanes)
        assert lanes.outer_size.height == 7
        await press(pilot, "ctrl+up", "ctrl+up")
        assert lanes.outer_size.height == 5
        await press(pilot, "enter", "ctrl+up")
        assert lanes.outer_size.height == 6
        assert not app.lesson_screen.check_action("wider", ())


async def test_a_key_for_sizes_that_changes_none_says_why() -> None:
    app = RecordedConsole("shared-group", EVENTS, 12.9)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        for size, keys, told in (
            (NARROW, ["ctrl+right"], "In a terminal below 120 × 34 a pane has the whole width."),
            (NARROW, ["ctrl+down"], "The lanes are all on screen: they need no more rows."),
            (NARROW, ["ctrl+up"] * 9, "It gets no taller: that is the limit."),
            (NARROW, ["enter", "ctrl+left"], "The lanes have the whole width."),
            (WIDE, ["z", "ctrl+left"], "What fills the screen has no other size."),
        ):
            await pilot.resize_terminal(*size)
            app.clear_notifications()
            await press(pilot, *keys)
            assert {note.message for note in app._notifications} == {told}


@pytest.mark.slow
async def test_a_size_ends_where_something_else_would_have_no_room() -> None:
    app = RecordedConsole("split-groups", split_groups_run().events, 9.4)
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        await press(pilot, "1", *["ctrl+right"] * 30)
        assert not app.lesson_screen.check_action("wider", ())
        assert app.lesson_screen.check_action("narrower", ())
        assert min(width(app, pane) for pane in ("code", "robot")) >= 20


@pytest.mark.slow
@pytest.mark.parametrize(
    "content", ['{"layout": "-grid", "left": 99}', '{"layout": "-grid", "left": 11, "right": 11}']
)
async def test_a_file_of_sizes_that_cannot_be_is_not_followed(content: str) -> None:
    state_folder().mkdir(parents=True, exist_ok=True)
    (state_folder() / "sizes.jsonl").write_text(content)
    app = RecordedConsole("split-groups", split_groups_run().events, 9.4)
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        assert width(app, "guide") > 30
        assert width(app, "code") > 30


@pytest.mark.parametrize("size", [NARROW, WIDE])
async def test_the_robots_pane_is_called_a_scene_only_while_it_shows_one(size: tuple[int, int]) -> None:
    app = RecordedConsole("stale-data", shared_group_run().events, 3.0)
    async with app.run_test(size=size) as pilot:
        await settle(pilot)
        await pilot.press("4")
        await settle(pilot)
        assert "4 Scene" in text_of(app)
        await pilot.press("c")
        await settle(pilot)
        assert "4 Robot" in text_of(app)
        assert "4 Scene" not in text_of(app)
