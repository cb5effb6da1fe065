"""``cbtui export``: what it writes, and what it refuses in one sentence."""

import csv
import json
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator, Sequence
from pathlib import Path

import perfetto.protos.perfetto.trace.perfetto_trace_pb2 as pb
import pytest

from cbtui import cli
from cbtui.runs.recorded.exporting import ExportError, ExportRequest, export
from sim.recording import RecordingMetadata, RecordingWriter
from sim.trace.events import AnyEvent, EntityAppeared, GroupAppeared, RunStarted, ThreadAppeared
from tests.export.examples import small_run
from tests.support.runs import shared_group_run

OUTPUTS = {
    "perfetto": "out.pftrace",
    "chrome": "out.json",
    "svg": "out.svg",
    "csv": "out.csv",
    "markdown": "out.md",
}


class Events:
    """A source that is no file; it breaks off after some batches if that is asked for."""

    def __init__(self, events: Sequence[AnyEvent], breaks_after: int | None = None) -> None:
        self._events = events
        self._breaks_after = breaks_after

    def batches(self) -> Iterator[list[AnyEvent]]:
        for number, start in enumerate(range(0, len(self._events), 10)):
            if number == self._breaks_after:
                raise OSError(5, "Input/output error")
            yield list(self._events[start : start + 10])


@pytest.fixture
def recording(tmp_path: Path) -> Path:
    path = tmp_path / "run.mcap"
    recorder = RecordingWriter(path, RecordingMetadata(title="small run"))
    recorder.take(small_run())
    recorder.close()
    return path


def options_for(folder: Path) -> list[str]:
    return [word for name, file in OUTPUTS.items() for word in (f"--{name}", str(folder / file))]


def assert_all_readable(folder: Path) -> None:
    trace = pb.Trace()
    trace.ParseFromString((folder / OUTPUTS["perfetto"]).read_bytes())
    assert trace.packet
    assert json.loads((folder / OUTPUTS["chrome"]).read_text())["traceEvents"]
    ElementTree.parse(folder / OUTPUTS["svg"])
    with (folder / OUTPUTS["csv"]).open(newline="") as file:
        assert list(csv.reader(file))
    assert "](<out.svg>)" in (folder / OUTPUTS["markdown"]).read_text()


def test_one_command_writes_every_format(recording: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["export", str(recording), *options_for(recording.parent)]) == 0
    assert_all_readable(recording.parent)
    told = [f"cbtui: wrote {recording.parent / file}" for file in OUTPUTS.values()]
    assert capsys.readouterr().err.splitlines() == told


def test_the_picture_shows_the_window_that_is_asked_for(recording: Path) -> None:
    picture = recording.parent / "lanes.svg"
    words = ["--svg", str(picture), "--from", "0.5", "--to", "1.5", "--width", "700"]
    assert cli.main(["export", str(recording), *words]) == 0
    root = ElementTree.parse(picture).getroot()
    assert root.get("width") == "700"
    assert "small run: 0.5 to 1.5 s, MultiThreadedExecutor" in picture.read_text()


def test_the_report_finds_its_picture_in_another_folder(recording: Path) -> None:
    folder = recording.parent
    (folder / "pictures").mkdir()
    words = ["--svg", str(folder / "pictures" / "lanes.svg"), "--markdown", str(folder / "out.md")]
    assert cli.main(["export", str(recording), *words]) == 0
    assert "](<pictures/lanes.svg>)" in (folder / "out.md").read_text()


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ([], "name what to write, such as --svg lanes.svg"),
        (["--csv", "{}/no/such/out.csv"], "no/such/out.csv cannot be written: there is no folder"),
        (["--csv", "{}"], "it is a folder"),
        (["--perfetto", "/dev/full"], "cannot write /dev/full: No space left on device"),
        (["--markdown", "/dev/full"], "cannot write /dev/full: No space left on device"),
        (["--csv", "{}/run.mcap"], "--csv would overwrite {}/run.mcap; give it a file of its own"),
        (["--csv", "{}/a", "--svg", "{}/a"], "would overwrite {}/a"),
        (["--csv", "{}/a", "--from", "1"], "--from, --to and --width are for the picture"),
        (["--svg", "{}/a", "--from", "2", "--to", "1"], "a picture from 2 to 1 s is empty"),
        (["--svg", "{}/a", "--from", "99"], "the run is over at 2.5 s, before --from 99"),
        (["--svg", "{}/a", "--from", "-1"], "-1 s is before the run begins"),
        (["--svg", "{}/a", "--width", "9"], "a picture cannot be 9 pixels wide; give 480 to 20000"),
        (["--svg", "{}/a", "--width", "wide"], "'wide' is not a whole number"),
    ],
)
def test_a_wrong_command_is_refused_in_one_sentence(
    recording: Path, capsys: pytest.CaptureFixture[str], words: list[str], sentence: str
) -> None:
    before = recording.read_bytes()
    arguments = ["export", str(recording), *(word.format(recording.parent) for word in words)]
    try:
        status = cli.main(arguments)
    except SystemExit as refusal:
        status = int(refusal.code or 0)
    said = capsys.readouterr().err
    assert status == 2
    assert sentence.format(recording.parent) in said
    assert len(said.splitlines()) == 1
    assert recording.read_bytes() == before


def test_a_file_that_is_no_recording_is_refused_and_leaves_outputs_alone(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    nonsense, kept = tmp_path / "run.mcap", tmp_path / "out.csv"
    nonsense.write_bytes(b"nonsense")
    kept.write_text("kept")
    for path in (nonsense, tmp_path / "missing.mcap", tmp_path):
        assert cli.main(["export", str(path), "--csv", str(kept), "--force"]) == 2
        assert len(capsys.readouterr().err.splitlines()) == 1
    assert kept.read_text() == "kept"


def test_a_cut_recording_gives_what_it_holds_and_one_sentence(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "run.mcap"
    recorder = RecordingWriter(path, RecordingMetadata(title="cut"))
    for event in shared_group_run().events:
        recorder.take([event])
    recorder.close()
    path.write_bytes(path.read_bytes()[:-2000])
    assert cli.main(["export", str(path), *options_for(tmp_path)]) == 0
    assert_all_readable(tmp_path)
    told = capsys.readouterr().err.splitlines()
    assert [line for line in told if ": wrote " not in line] == told[len(OUTPUTS) :]
    assert len(told) == len(OUTPUTS) + 1


def test_events_without_their_beginning_are_exported(tmp_path: Path) -> None:
    beginnings = (RunStarted, ThreadAppeared, GroupAppeared, EntityAppeared)
    events = [event for event in small_run() if not isinstance(event, beginnings)]
    export(Events(events).batches, ExportRequest({name: tmp_path / file for name, file in OUTPUTS.items()}))
    assert_all_readable(tmp_path)


def test_a_source_that_breaks_off_is_told_of(tmp_path: Path) -> None:
    with pytest.raises(ExportError, match="the recording cannot be read: Input/output error"):
        export(Events(small_run(), breaks_after=2).batches, ExportRequest({"csv": tmp_path / "out.csv"}))


def test_a_recording_without_events_is_told_of(tmp_path: Path) -> None:
    with pytest.raises(ExportError, match="no events"):
        export(Events([]).batches, ExportRequest({"csv": tmp_path / "out.csv"}))
    assert not (tmp_path / "out.csv").exists()
