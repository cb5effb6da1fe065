"""Recording from the command line, and what is told of a recording."""

import subprocess
import sys
from pathlib import Path

import pytest
from rosbags.highlevel import AnyReader

from cbtui import cli
from cbtui.runs.recorded.recording_file import CannotRecordError, setup_of, start_recording
from sim.engine.setup import RunSetup, TimedCall
from sim.recording import RecordingMetadata, read
from sim.releases.profile import Profile
from tests.recording.files import write
from tests.support.daily import first_row_daily
from tests.trace.samples import FULL


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("recording") / "run.mcap"
    command = [sys.executable, "-m", "cbtui", "run", "exclusive-2-threads", "--for", "5", "--call", "2.5"]
    done = subprocess.run([*command, "--record", str(path)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return path


@pytest.mark.slow
def test_a_recorded_run_holds_its_events_set_up_and_topics(recorded: Path) -> None:
    recording = read(recorded)
    setup = setup_of(recording.about)
    assert setup is not None
    assert setup.calls == (TimedCall(2_500_000_000, data=True),)
    assert setup.until == 5_000_000_000
    assert list(recording.sources) == [setup.programs[0].path]
    counts = {topic.name: topic.count for topic in recording.topics()}
    with AnyReader([recorded]) as reader:
        assert counts.items() <= {name: each.msgcount for name, each in reader.topics.items()}.items()
        for connection, _, data in reader.messages():
            reader.deserialize(data, connection.msgtype)
    assert recording.damage is None


def test_info_tells_what_is_in_a_recording(recorded: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["info", str(recorded)]) == 0
    told = capsys.readouterr()
    labels = {line.split()[0]: line for line in told.out.splitlines()}
    assert labels["run"] == "run        exclusive-2-threads, virtual clock"
    assert labels["like"] == f"like       rclpy of {Profile()}"
    assert labels["program"].endswith("node.py, with its source")
    assert labels["lasts"] == "lasts      5.000 s; its time was up"
    assert told.err == ""


def test_info_gives_what_is_left_of_a_recording_and_one_sentence(
    recorded: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(recorded.read_bytes()[: recorded.stat().st_size // 2])
    assert cli.main(["info", str(cut)]) == 1
    told = capsys.readouterr()
    assert told.out.startswith("run        exclusive-2-threads")
    assert len(told.err.splitlines()) == 1
    assert told.err.startswith(f"cbtui: {cut}: it breaks off at byte ")


def test_a_comparison_with_a_damaged_recording_says_what_is_missing(
    recorded: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    cut = tmp_path / "cut.mcap"
    # How much of the run half a file has is by its chunks, which the recorder ends by the real time.
    cut.write_bytes(recorded.read_bytes()[:-100])
    assert cli.main(["compare", str(recorded), str(cut), "--text"]) == 0
    assert f"cbtui: {cut}: all of it is there but its index" in capsys.readouterr().err


def test_info_says_what_is_no_recording(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = tmp_path / "notes.txt"
    text.write_text("nothing of the kind")
    assert cli.main(["info", str(text)]) == 2
    assert capsys.readouterr().err == (
        f"cbtui: {text} is not a recording: it has nothing of an MCAP file in it\n"
    )


def test_info_tells_of_losses_and_prints_no_control_characters(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "run.mcap"
    write(path, FULL, RecordingMetadata(title="shared\x1bgroup"))
    assert cli.main(["info", str(path)]) == 0
    out = capsys.readouterr().out
    assert "12 events came too fast to be kept" in out
    assert "3 messages came too fast for their contents to be kept" in out
    assert "shared␛group" in out


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    first_row_daily(
        (["--record", "{there}"], "there is a file {there} already; give another name, or --force"),
        (["--record", "/no/such/folder/x.mcap"], "cannot be written: there is no folder /no/such"),
        (["--record", "/dev/full", "--force"], "cannot record to /dev/full: No space left on device"),
        (["--force"], "--force replaces files that are there already; no file to write is named"),
    ),
)
def test_what_cannot_be_recorded_is_refused_before_the_run(
    arguments: list[str], sentence: str, tmp_path: Path
) -> None:
    there = tmp_path / "there.mcap"
    there.write_text("precious")
    filled = [argument.format(there=there) for argument in arguments]
    command = [sys.executable, "-m", "cbtui", "run", "single-thread", *filled]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (2, "")
    assert sentence.format(there=there) in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert there.read_text() == "precious"


def test_a_recording_that_cannot_be_begun_removes_nothing_that_was_there(tmp_path: Path) -> None:
    device = tmp_path / "full.mcap"
    device.symlink_to("/dev/full")
    with pytest.raises(CannotRecordError, match="No space left on device"):
        start_recording(device, RunSetup(title="a run", programs=()), replace=True)
    assert device.is_symlink()
