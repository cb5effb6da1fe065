"""Keys that come while the console is still at the keys before, and what it says if it fails at one."""

import sys
from pathlib import Path

import pytest

from cbtui.terminal.ending import FAULT
from sim.recording import read
from tests.support.daily import first_daily
from tests.support.processes import wait_until_gone
from tests.terminal.console import opened

pytestmark = pytest.mark.skipif(
    sys.platform != "linux", reason="a terminal of its own is made for the console"
)

_OPEN, _LEAVE = "\r", "q"
_PALETTE, _PAGE_DOWN = "\x10", "\x1b[6~"
_FAULTY = """\
from cbtui.screens.parts.engine_keys import WorldKeys
def fail(self):
    raise ZeroDivisionError("[red]as planted[/red]")
WorldKeys.action_call_service = fail
from cbtui.__main__ import command
raise SystemExit(command())
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    "keys", first_daily(_OPEN * 3 + _LEAVE * 2, _OPEN + _LEAVE, _LEAVE + _OPEN, _LEAVE * 3)
)
def test_keys_that_open_and_leave_at_once_do_no_harm(keys: str, tmp_path: Path) -> None:
    with opened(80, 24, tmp_path) as console:
        console.until("Unit 5")
        console.press(keys)
        while console.process.poll() is None:
            console.press(_LEAVE)
            console.read_for(0.2)
        assert console.ended() == 0, console.said()
        assert console.left_on() == set()


@pytest.mark.slow
def test_paging_through_the_palette_before_it_is_shown_does_nothing(tmp_path: Path) -> None:
    with opened(80, 24, tmp_path) as console:
        console.until("Unit 5")
        console.press(_PALETTE + _PAGE_DOWN)
        console.until("Search")
        console.press("\x1b")
        console.until("Unit 5")
        console.press(_LEAVE)
        assert console.ended() == 0, console.said()


@pytest.mark.slow
def test_a_fault_of_the_consoles_own_is_told_in_a_sentence_and_loses_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with opened(80, 24, tmp_path, "open", "split-groups", program=["-c", _FAULTY]) as console:
        console.until("What do you expect?")
        console.press("\x1b")
        console.until("LIVE")
        console.press("R")
        console.until("Recording to")
        theirs = console.started()
        console.press("s")
        assert console.ended() == 1
        assert console.left_on() == set()
        said = console.said()
        wait_until_gone(theirs)
    fault = tmp_path / "cbtui" / FAULT
    assert "Traceback" not in said
    assert "ended the console (ZeroDivisionError: [red]as planted[/red])" in said
    assert str(fault) in said
    assert "in fail" in fault.read_text(encoding="utf-8")
    (recording,) = map(read, tmp_path.glob("*.mcap"))
    assert recording.damage is None
    assert sum(map(len, recording.batches())) > 0
