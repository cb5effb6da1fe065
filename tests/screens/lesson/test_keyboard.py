"""The console as the terminal of a program that reads: who reads is said, and what is typed goes to it."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import pytest
from textual.pilot import Pilot

from cbtui.widgets.shell import ProgramKeyboard, ShellOutput
from sim.engine.commands import TerminalInput
from sim.trace.events import AnyEvent, KeyboardAsked, Printed, Reading, RunEnded, Typed
from tests.support.builder import ns
from tests.support.console import NARROW, WIDE, RecordedConsole, settle
from tests.support.daily import first_daily
from tests.support.pictures import text_of
from tests.support.runs import dummy_server_run

NAME = "teleop.py"


@asynccontextmanager
async def console(
    reads: Reading, size: tuple[int, int] = NARROW
) -> AsyncIterator[tuple[RecordedConsole, Pilot[None]]]:
    app = RecordedConsole("reentrant-1-thread", dummy_server_run().events, 1.0)
    async with app.run_test(size=size) as pilot:
        await settle(pilot)
        await tell(
            app, pilot, Printed(ns(1.0), "speed? ", False, ends=False), KeyboardAsked(ns(1.0), reads, NAME)
        )
        yield app, pilot


async def tell(app: RecordedConsole, pilot: Pilot[None], *events: AnyEvent) -> None:
    app.engines.latest._deliver(list(events))
    await settle(pilot)


async def press(pilot: Pilot[None], *keys: str) -> None:
    await pilot.press(*keys)
    await settle(pilot)


def typed(app: RecordedConsole) -> list[str]:
    return [command.text for command in app.engines.latest.commands if isinstance(command, TerminalInput)]


@pytest.mark.parametrize("size", first_daily(WIDE, NARROW))
async def test_it_is_said_who_reads_and_where_to_type(size: tuple[int, int]) -> None:
    async with console(Reading.LINES, size) as (app, pilot):
        assert "teleop.py waits for input from the keyboard; type it in the shell pane (i)" in text_of(app)
        await press(pilot, "i")
        assert "teleop.py reads a line: type here; ^] goes back" in text_of(app)


async def test_a_line_goes_to_the_program_and_is_seen_behind_what_it_asked() -> None:
    async with console(Reading.LINES) as (app, pilot):
        await press(pilot, "i", "0", "full_stop", "5", "s", "enter")
        assert typed(app) == ["0.5s\n"]
        await tell(app, pilot, Typed(ns(1.1), "0.5s\n"), Printed(ns(1.1), "so be it", False))
        text = text_of(app)
        assert "speed? 0.5s" in text
        assert "so be it" in text
        await press(pilot, "ctrl+c")
        assert typed(app) == ["0.5s\n", "\x03"]


@pytest.mark.slow
async def test_each_key_goes_to_a_program_that_takes_keys_but_the_one_that_leads_out() -> None:
    async with console(Reading.RAW) as (app, pilot):
        await press(pilot, "i", "w", "space", "q", "enter", "escape", "up", "ctrl+c", "tab", "question_mark")
        assert typed(app) == ["w", " ", "q", "\r", "\x1b", "\x1b[A", "\x03", "\t", "?"]
        await press(pilot, "ctrl+right_square_bracket")
        assert isinstance(app.screen.focused, ShellOutput)
        await press(pilot, "i", "d")
        assert typed(app)[-1] == "d"


@pytest.mark.slow
async def test_a_password_is_not_shown() -> None:
    async with console(Reading.SECRET) as (app, pilot):
        await press(pilot, "i", "x", "y", "z")
        assert "xyz" not in text_of(app)
        assert app.screen.query_one(ProgramKeyboard).value == "xyz"


async def test_the_keys_mean_what_they_did_once_the_run_is_over() -> None:
    async with console(Reading.RAW) as (app, pilot):
        await press(pilot, "i")
        await tell(app, pilot, RunEnded(ns(1.2), "the program returned", False))
        assert isinstance(app.screen.focused, ShellOutput)
