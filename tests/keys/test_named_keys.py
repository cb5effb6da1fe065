"""Whoever has other keys reads of those, wherever a text names one."""

import pytest

from cbtui.app import CbtuiApp
from cbtui.keys.keymap import STANDARD, Keymap
from cbtui.keys.named_keys import key_in_force, with_keys_in_force
from cbtui.widgets.guide import Guide
from lessons.catalogue import lessons
from tests.support.console import WIDE, RecordedConsole, predict, settle
from tests.support.fake_session import FakeEngines
from tests.support.pictures import text_of
from tests.support.runs import shared_group_run

OTHER = Keymap(
    {
        "lesson.call_service": ("k",),
        "lesson.threads": ("T",),
        "lesson.run_again": ("A",),
        "lesson.record": ("W",),
    }
)


def test_a_key_in_backticks_is_the_one_that_the_person_has() -> None:
    assert with_keys_in_force("- `s` calls it, `t` asks; `space` stops.", OTHER) == (
        "- `k` calls it, `T` asks; `space` stops."
    )


def test_a_key_that_two_actions_share_becomes_both_keys() -> None:
    assert with_keys_in_force("press `r`", OTHER) == "press `A` or `r`"
    assert key_in_force("r", OTHER) == "A or r"


@pytest.mark.parametrize(
    "text",
    [
        "`spin()` and `sub_node` are code",
        "```python\ns = `s`\n```\n",
        "``s`` is quoted otherwise",
        r"a recorded title \`s\`",
        "no key: s, t",
    ],
)
def test_what_is_no_key_stays(text: str) -> None:
    assert with_keys_in_force(text, OTHER) == text


def test_nothing_changes_for_who_has_the_consoles_own_keys() -> None:
    text = "`s` `S` `space` `,` `.` `<` `[` `0` `G` `:` `left` `?` `10` `work`"
    assert with_keys_in_force(text, STANDARD) == text


def test_keys_that_change_places_are_not_changed_twice() -> None:
    keymap = Keymap({"lesson.call_service": ("t",), "lesson.threads": ("s",)})
    assert with_keys_in_force("`s`, then `t`", keymap) == "`t`, then `s`"


async def test_the_end_of_a_run_names_the_keys_in_force() -> None:
    app = RecordedConsole("shared-group", shared_group_run().events, 14.25, keys=OTHER)
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        app.engines.latest.end("the engine was killed by signal 9")
        await settle(pilot)
        assert "engine lost: killed by signal 9; A runs again" in text_of(app)


async def test_the_menu_names_the_keys_in_force() -> None:
    app = CbtuiApp(open_session=FakeEngines([], 0), keys=OTHER)
    predict(app, lessons()[0].id)
    async with app.run_test(size=WIDE) as pilot:
        await pilot.pause()
        screen = text_of(app)
        assert "k pressed at" in screen
        assert "s pressed at" not in screen


@pytest.mark.slow
async def test_the_guide_on_screen_names_the_keys_in_force() -> None:
    pages = []
    for keys in (STANDARD, OTHER):
        app = RecordedConsole("shared-group", shared_group_run().events, 5.0, keys=keys)
        async with app.run_test(size=(140, 90)) as pilot:
            await pilot.press("1", "z")
            await settle(pilot)
            assert app.lesson_screen.query_one(Guide).display
            pages.append(text_of(app))
    usual, other = pages
    assert "s and S switch the motors" in usual
    assert "k and S switch the motors" in other
