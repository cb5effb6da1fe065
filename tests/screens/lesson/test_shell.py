"""The shell pane: lines typed, what they wrote, history, completion."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import pytest
from textual.pilot import Pilot

from cbtui.widgets.shell import Prompt, ShellOutput
from sim.engine.commands import CompleteLine, InterruptLine, RunLine
from sim.trace.events import AnyEvent, LineCompleted, LineEnded, LineGiven, LineSaid, Printed, Typed
from tests.support.builder import ns
from tests.support.console import NARROW, WIDE, RecordedConsole, settle
from tests.support.daily import first_daily
from tests.support.pictures import lines_of, text_of
from tests.support.runs import dummy_server_run

SAID: list[AnyEvent] = [
    LineGiven(ns(1.0), 1, "ros2 topic list"),
    LineSaid(ns(1.0), 1, "/odom", False),
    LineSaid(ns(1.0), 1, "/scan\x1b[31m", False),
    LineEnded(ns(1.0), 1, 0),
    LineGiven(ns(2.0), 2, "ros2 topic type /nothing"),
    LineSaid(ns(2.0), 2, "Unknown topic", True),
    LineEnded(ns(2.0), 2, 1),
]


@asynccontextmanager
async def console(size: tuple[int, int] = NARROW) -> AsyncIterator[tuple[RecordedConsole, Pilot[None]]]:
    app = RecordedConsole("reentrant-1-thread", dummy_server_run().events, 5.0)
    async with app.run_test(size=size) as pilot:
        await settle(pilot)
        yield app, pilot


async def press(pilot: Pilot[None], *keys: str) -> None:
    await pilot.press(*keys)
    await settle(pilot)


async def type_text(pilot: Pilot[None], text: str) -> None:
    names = {" ": "space", "/": "slash", "_": "underscore"}
    await press(pilot, *(names.get(letter, letter) for letter in text))


async def deliver(app: RecordedConsole, pilot: Pilot[None], events: list[AnyEvent]) -> None:
    app.engines.latest._deliver(events)
    await settle(pilot)


def prompt(app: RecordedConsole) -> Prompt:
    return app.screen.query_one(Prompt)


async def test_a_line_goes_to_the_engine_and_other_keys_do_not_act_while_typing() -> None:
    async with console() as (app, pilot):
        await press(pilot, "colon")
        await type_text(pilot, "ros2 topic list s")
        await press(pilot, "left", "right", "enter")
        assert app.engines.latest.commands == [RunLine(1, "ros2 topic list s")]
        assert prompt(app).value == ""


async def test_enter_on_the_shell_opens_its_prompt_while_the_engine_lives() -> None:
    async with console() as (app, pilot):
        await press(pilot, "6", "enter")
        await type_text(pilot, "ros2 topic list")
        await press(pilot, "enter")
        assert app.engines.latest.commands == [RunLine(1, "ros2 topic list")]


@pytest.mark.slow
async def test_what_lines_wrote_is_shown_with_control_characters_made_visible() -> None:
    async with console() as (app, pilot):
        await press(pilot, "6")
        await deliver(app, pilot, SAID)
        text = text_of(app)
        for shown in ("$ ros2 topic list", "/odom", "Unknown topic", "(ended with status 1)"):
            assert shown in text
        assert "\x1b" not in text
        assert "/scan" in text


@pytest.mark.slow
async def test_a_tab_that_a_line_wrote_is_shown_as_blanks() -> None:
    shown = LineSaid(ns(1.0), 1, "float64 x\n\tint32 sec", False)
    async with console() as (app, pilot):
        await press(pilot, "6")
        await deliver(app, pilot, [LineGiven(ns(1.0), 1, "ros2 interface show a/msg/B"), shown])
        (first,) = (line for line in lines_of(app) if "float64 x" in line)
        (second,) = (line for line in lines_of(app) if "int32 sec" in line)
        assert second.index("int32") == first.index("float64") + 8


async def test_a_long_line_goes_on_in_the_next_row_also_after_its_rest_was_typed_and_in_another_size() -> (
    None
):
    long = " ".join(f"/topic_{number}" for number in range(30))
    said: list[AnyEvent] = [
        LineGiven(ns(1.0), 1, "ros2 node list"),
        LineSaid(ns(1.0), 1, long, False),
        Printed(ns(1.5), "answer> " * 10, False, False),
        Typed(ns(1.6), long + "\n"),
    ]
    async with console() as (app, pilot):
        await press(pilot, "6")
        await deliver(app, pilot, said)
        for size in ((96, 30), NARROW):
            await pilot.resize_terminal(*size)
            await settle(pilot)
            app.screen.query_one(ShellOutput).scroll_home(animate=False)
            await settle(pilot)
            rows = "".join(line.strip("│ ▁▂▃▄▅▆▇█") for line in lines_of(app)).replace(" ", "")
            assert rows.count(long.replace(" ", "")) == 2


@pytest.mark.slow
async def test_looking_back_shows_what_had_been_written_by_then() -> None:
    async with console() as (app, pilot):
        await press(pilot, "6")
        output = app.screen.query_one(ShellOutput)
        output.show(app.lesson_screen.runs.run.timeline, 0)
        await deliver(app, pilot, SAID)
        output.show(app.lesson_screen.runs.run.timeline, ns(1.5))
        await pilot.pause()
        assert "Unknown topic" not in text_of(app)
        assert "/odom" in text_of(app)


async def test_up_and_down_bring_lines_back() -> None:
    async with console() as (app, pilot):
        await press(pilot, "colon")
        for line in ("one", "two", "one"):
            await type_text(pilot, line)
            await press(pilot, "enter")
        seen = []
        for key in ("up", "up", "up", "down", "down"):
            await press(pilot, key)
            seen.append(prompt(app).value)
        assert seen == ["one", "two", "two", "one", ""]


async def test_tab_asks_and_the_answer_fills_in_what_is_common() -> None:
    async with console() as (app, pilot):
        await press(pilot, "colon")
        await type_text(pilot, "ros2 top")
        await press(pilot, "tab")
        assert app.engines.latest.commands == [CompleteLine(1, "ros2 top", 8)]
        await deliver(app, pilot, [LineCompleted(ns(5.0), 1, 5, ("topic",))])
        assert prompt(app).value == "ros2 topic "
        await type_text(pilot, "echo /")
        await press(pilot, "tab")
        await deliver(app, pilot, [LineCompleted(ns(5.0), 2, 16, ("/robot/odom", "/robot/scan"))])
        assert prompt(app).value == "ros2 topic echo /robot/"
        assert any("/robot/odom  /robot/scan" in line for line in lines_of(app))
        await type_text(pilot, "s")
        assert not any("/robot/odom  /robot/scan" in line for line in lines_of(app))


async def test_a_completion_that_comes_after_enter_is_dropped() -> None:
    async with console() as (app, pilot):
        await press(pilot, "colon")
        await type_text(pilot, "topic l")
        await press(pilot, "tab", "enter")
        await deliver(app, pilot, [LineCompleted(ns(5.0), 1, 6, ("list",))])
        assert prompt(app).value == ""


@pytest.mark.slow
async def test_no_completion_leaves_the_line_alone() -> None:
    async with console() as (app, pilot):
        await press(pilot, "colon")
        await type_text(pilot, "ros2 xyz")
        await press(pilot, "tab")
        await deliver(app, pilot, [LineCompleted(ns(5.0), 1, 5, ())])
        assert prompt(app).value == "ros2 xyz"


async def test_ctrl_c_interrupts_the_last_line_and_escape_gives_the_keys_back() -> None:
    async with console() as (app, pilot):
        await press(pilot, "colon")
        await type_text(pilot, "x")
        await press(pilot, "enter", "ctrl+c", "escape", "1")
        assert app.engines.latest.commands == [RunLine(1, "x"), InterruptLine(1)]
        assert not app.screen.query_one(ShellOutput).has_focus


@pytest.mark.parametrize("size", first_daily(NARROW, WIDE), ids=["80x24", "140x40"])
async def test_the_prompt_has_a_line_of_its_own(size: tuple[int, int]) -> None:
    async with console(size) as (app, pilot):
        await press(pilot, "colon")
        await type_text(pilot, "ros2")
        assert any(line.strip(" │").startswith("ros2") for line in lines_of(app))


@pytest.mark.slow
async def test_the_line_of_keys_shows_what_works_while_typing() -> None:
    async with console(WIDE) as (app, pilot):
        await press(pilot, "colon")
        assert "esc other keys" in lines_of(app)[-1]
        assert "service" not in lines_of(app)[-1]
        await press(pilot, "escape")
        assert "service" in lines_of(app)[-1]
