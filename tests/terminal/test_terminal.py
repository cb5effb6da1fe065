"""The console in a real terminal: a lesson from the menu and out again, and nothing is left of it."""

import sys
from pathlib import Path
from signal import SIGTERM

import pytest

from tests.support.daily import first_row_daily
from tests.support.processes import wait_until_gone
from tests.terminal.console import opened

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="processes are looked up in /proc")

_LOG = "5"
_SPLIT_GROUPS = "3\r"
_ESCAPE = "\x1b"
"""Out of the question what one expects, without an answer."""


@pytest.mark.parametrize(("columns", "rows"), first_row_daily((80, 24), (140, 40)), ids=["80x24", "140x40"])
def test_a_lesson_is_chosen_called_paused_scrubbed_and_left_and_nothing_stays(
    columns: int, rows: int, tmp_path: Path
) -> None:
    with opened(columns, rows, tmp_path) as console:
        console.until("Split groups")
        console.press(_SPLIT_GROUPS)
        console.until("What do you expect?")
        console.press(_ESCAPE)
        console.until("LIVE")
        console.press(_LOG)
        console.press("s")
        console.until("/motor_power replied")
        theirs = console.started()
        assert theirs
        console.press(" ")
        console.until("PAUSED")
        console.press("[")
        console.until("BACK")
        console.press("0")
        console.press(" ")
        console.until("LIVE")
        console.press("q")
        console.until("Unit 5")
        console.press("q")
        assert console.ended() == 0, console.said()
        assert console.left_on() == set()
        wait_until_gone(theirs)


@pytest.mark.slow
def test_a_terminal_is_as_it_was_when_the_console_is_ended_from_outside(tmp_path: Path) -> None:
    with opened(80, 24, tmp_path) as console:
        console.until("Split groups")
        console.press(_SPLIT_GROUPS)
        console.until("What do you expect?")
        console.press(_ESCAPE)
        console.until("LIVE")
        console.process.terminate()
        assert console.ended() == 128 + SIGTERM
        assert console.left_on() == set()


@pytest.mark.slow
def test_that_something_is_opened_is_said_before_the_console_draws_and_leaves_no_trace(
    tmp_path: Path,
) -> None:
    with opened(80, 24, tmp_path, "open", "split-groups") as console:
        console.until("What do you expect?")
        assert console.drawn.index(b"opening ...") < console.drawn.index(b"\x1b[?1049h")
        console.press(_ESCAPE)
        console.until("LIVE")
        console.press("q")
        console.until("Unit 5")
        console.press("q")
        assert console.ended() == 0, console.said()
        assert b"\x1b[K" in console.drawn.rpartition(b"\x1b[?1049l")[2]


@pytest.mark.slow
def test_an_enter_typed_before_the_console_draws_opens_the_chosen_lesson(tmp_path: Path) -> None:
    with opened(80, 24, tmp_path) as console:
        console.until("opening ...")
        console.press("\r")
        console.until("What do you expect?")
        console.press(_ESCAPE)
        console.until("LIVE")
        console.press("q")
        console.until("Unit 5")
        console.press("q")
        assert console.ended() == 0, console.said()
