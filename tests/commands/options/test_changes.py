"""Changing a program's set-up from the command line: what runs, what is recorded, what is refused."""

import json
import time
from pathlib import Path
from typing import Any

import pytest

from cbtui import cli
from cbtui.commands.options import changes
from cbtui.runs.recorded.recording_file import setup_of
from sim.engine.setup import GroupChange, PeriodChange
from sim.recording import read
from tests.support.commands import cbtui

CHANGES = (
    *("--group", "SetBool_callback=shared"),
    *("--group", "/service_start_turn:timer_callback=shared"),
    *("--period", "timer_callback=0.5"),
    *("--sensor-rate", "5"),
)

LATER = """
import rclpy
from rclpy.node import Node

class Late(Node):
    def __init__(self):
        super().__init__('late')
        self.timer = self.create_timer(0.5, self.tick)

    def tick(self):
        self.timer.cancel()
        self.create_timer(0.5, self.ticks)

    def ticks(self):
        print('ticks')

rclpy.init()
rclpy.spin(Late())
"""


def starts(file: Path, callback: str) -> list[float]:
    """When a callback started, in seconds."""
    events: list[dict[str, Any]] = [json.loads(line) for line in file.read_text().splitlines()]
    return [
        each["t"] for each in events if each["event"] == "callback_start" and each["callback"] == callback
    ]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where ``run.mcap`` and ``run.jsonl`` tell of a changed run with a call."""
    folder = tmp_path_factory.mktemp("changes")
    files = ["--record", str(folder / "run.mcap"), "--events", str(folder / "run.jsonl")]
    done = cbtui("run", "exclusive-2-threads", "--for", "8", "--call", "1.2", *CHANGES, *files)
    assert done.returncode == 0, done.stderr
    return folder


def test_a_changed_run_has_its_groups_and_periods(folder: Path) -> None:
    ticks = starts(folder / "run.jsonl", "timer_callback")
    assert ticks[:2] == [0.5, 1.0]
    assert not [at for at in ticks if 1.2 < at < 6.2]


def test_a_recording_holds_the_changes_and_tells_of_them(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    setup = setup_of(read(folder / "run.mcap").about)
    assert setup is not None
    assert setup.groups == (
        GroupChange("", "SetBool_callback", "shared"),
        GroupChange("/service_start_turn", "timer_callback", "shared"),
    )
    assert setup.periods == (PeriodChange("", "timer_callback", 500_000_000),)
    assert setup.sensor_rate == 5
    assert cli.main(["info", str(folder / "run.mcap")]) == 0
    told = capsys.readouterr().out
    assert "changed    SetBool shared group, timer shared group, timer every 0.5 s, sensors 5 Hz\n" in told


def test_a_repeated_run_is_changed_in_the_same_way(folder: Path) -> None:
    again = folder / "again.jsonl"
    done = cbtui("run", "--inputs", str(folder / "run.mcap"), "--events", str(again))
    assert done.returncode == 0, done.stderr
    assert again.read_bytes() == (folder / "run.jsonl").read_bytes()


def test_a_repeated_run_can_be_changed_once_more(folder: Path) -> None:
    other = folder / "other.jsonl"
    words = ["--group", "timer_callback=own", "--group", "/service_start_turn:timer_callback=own"]
    done = cbtui("run", "--inputs", str(folder / "run.mcap"), *words, "--events", str(other))
    assert done.returncode == 0, done.stderr
    assert [at for at in starts(other, "timer_callback") if 1.2 < at < 6.2]


def test_a_callback_that_there_is_not_is_a_slip() -> None:
    done = cbtui("run", "exclusive-2-threads", "--for", "1", "--group", "timer_calback=own")
    assert done.returncode == 2
    told = "no callback is named timer_calback; there are SetBool_callback, timer_callback; did you mean"
    assert f"{told} timer_callback?" in done.stderr
    assert not done.stdout


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (("--group", "scan_callbck=own"), "did you mean scan_callback?"),
        (("--period", "nonsense=1"), "no timer callback is named nonsense; there is timer_callback"),
        (("--group", "/pub_node:scan_callback=own"), "no callback is named scan_callback in /pub_node"),
    ],
)
def test_a_run_ends_as_soon_as_a_change_proves_to_be_for_no_callback(
    change: tuple[str, str], told: str, tmp_path: Path
) -> None:
    begun, summary = time.monotonic(), tmp_path / "summary.json"
    asked = ("single-thread", "--clock", "real", "--for", "60", "--json", str(summary))
    done = cbtui("run", *asked, *change)
    assert (done.returncode, done.stdout, summary.exists()) == (2, "", False)
    assert told in done.stderr
    assert time.monotonic() - begun < 50


def test_a_callback_that_is_no_timer_is_told_once() -> None:
    done = cbtui("run", "single-thread", "--for", "1", "--period", "odom_callback=1")
    told = [line for line in done.stderr.splitlines() if line.startswith("cbtui: ")]
    assert told == ["cbtui: no timer callback is named odom_callback; there is timer_callback"]


def test_a_callback_that_the_program_makes_later_is_waited_for(tmp_path: Path) -> None:
    written = tmp_path / "later.py"
    written.write_text(LATER)
    done = cbtui("run", str(written), "--clock", "virtual", "--for", "3", "--group", "ticks=own")
    assert (done.returncode, done.stderr) == (0, "")
    assert "ticks" in done.stdout


@pytest.mark.parametrize("command", ["run", "open"])
@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (
            ["--group", "odom_callback"],
            "'odom_callback' is not a callback and its value; give a group, such as",
        ),
        (["--group", "=own"], "'=own' is not a callback and its value"),
        (["--group", ":odom_callback=own"], "':odom_callback=own' is not a callback and its value"),
        (["--group", "odom_callback=any"], "'any' is not a group; give own, shared, reentrant or default"),
        (["--period", "timer_callback"], "give seconds, such as timer_callback=0.2"),
        (["--period", "timer_callback=0"], "0 is not a period; give 0.001 to 3600 s"),
        (["--period", "timer_callback=soon"], "'soon' is not a number; give 0.001 to 3600 s"),
        (["--sensor-rate", "0"], "0 is not a sensor rate; give 0.1 to 100 Hz"),
        (["--sensor-rate", "inf"], "inf is not a sensor rate; give 0.1 to 100 Hz"),
        (["--threads", "0"], "an executor cannot have 0 threads here; give 1 to 64"),
    ],
)
def test_a_change_that_cannot_be_made_is_refused_in_one_line(
    command: str, words: list[str], sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as refused:
        cli.main([command, "shared-group", *words])
    assert refused.value.code == 2
    error = capsys.readouterr().err
    assert sentence in error
    assert len(error.splitlines()) == 1


def test_changes_can_be_said_again_as_options() -> None:
    said = [*CHANGES, "--threads", "3"]
    options = cli._parser().parse_args(["explore", "mine.py", *said])
    again = changes.words(changes.changes_of(options))
    assert sorted(again) == sorted(said)
