"""The tables of faults: their tests are there, and how long keys took is recorded of every fault."""

import re
import sys
from pathlib import Path

import pytest

from tests.faults.answering import FILE, PART, line_of, main
from tests.faults.catalogue import FAULTS
from tests.faults.support import ANSWERED
from tests.soak.results import read

HERE = Path(__file__).parent
ROWS = re.findall(
    r"^\| (?!Fault|---)(.+?) \| (.+) \| (.+) \|$", (HERE / "README.md").read_text(), re.MULTILINE
)


def test_every_fault_of_the_tables_has_tests_that_are_there() -> None:
    assert len(ROWS) > 50
    for fault, _, tests in ROWS:
        files = re.findall(r"`(\S+\.py)`", tests)
        assert files, fault
        assert all((HERE / file).is_file() for file in files), fault


def test_it_is_recorded_of_every_fault_that_keys_are_answered_in_time() -> None:
    recorded = read(FILE)[PART]
    assert set(recorded) == set(FAULTS)
    assert {name for name, entry in recorded.items() if float(entry["half_ms"]) > ANSWERED * 1e3} == set()


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="processes are looked up in /proc")
def test_the_command_presses_keys_while_a_fault_goes_on_and_tells_the_waits(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["answering", "os._exit", "--presses", "2"])
    assert main() in {0, 1}  # how long it took is the machine's affair
    assert re.fullmatch(
        r"os\._exit +half of 2 keys within +\d+ ms, all +\d+ ms( +over)?\n", capsys.readouterr().out
    )


def test_a_fault_during_which_half_of_the_keys_take_too_long_is_marked() -> None:
    assert line_of("slow", [0.1, 0.3, 0.4]).endswith("half of 3 keys within  300 ms, all   400 ms  over")
    assert line_of("quick", [0.1, 0.2, 0.4]).endswith("all   400 ms")
