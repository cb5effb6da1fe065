"""What once crashed a reader, each in the smallest form that did: it is refused in a sentence now."""

from pathlib import Path

import msgspec
import pytest

from cbtui.keys.config import read_text
from lessons.lesson import BadLesson, read_lesson
from sim.diagnosis import diagnose
from sim.engine import commands
from sim.interfaces import DefinitionError
from sim.interfaces.notation import parse
from sim.packages import PackageError, find_packages
from sim.recording import batch, read
from sim.ros.context.arguments import ArgumentsError, parse_arguments
from sim.ros.parameters.yaml_files import read_value
from sim.trace import events as ev
from sim.trace.timeline import Timeline
from tests.recording.files import write
from tests.support.runs import Run
from tests.trace.samples import CAST

_DEEP = "[" * 5000


@pytest.mark.parametrize(
    "data", [b"\x91\x92\xa3log\x00", b"\x91\x96\xa3log\x00\xa4INFO\xa1\xff\xa0\x00", b"\x91" * 5000]
)
def test_bytes_that_are_no_events_are_refused_whatever_is_wrong_with_them(data: bytes) -> None:
    with pytest.raises(msgspec.DecodeError):
        ev.decode(data)


def test_a_text_that_is_no_utf8_is_refused_as_any_other_bad_event() -> None:
    packed = ev.encode([ev.Printed(0, "\x7f" * 5, False)]).replace(b"\x7f" * 5, b"\xff" * 5)
    with pytest.raises(msgspec.DecodeError):
        ev.decode(packed)
    with pytest.raises(batch.BatchError):
        batch.unpack_batch(batch._HEAD.pack(batch._LITTLE_ENDIAN_CDR, batch.FORMAT, len(packed)) + packed)


def test_a_recording_with_such_a_text_in_it_is_damaged_there_and_read_all_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pack = ev.encode
    monkeypatch.setattr(batch, "encode", lambda events: pack(events).replace(b"\x7f" * 5, b"\xff" * 5))
    write(tmp_path / "run.mcap", [ev.Printed(0, "\x7f" * 5, False)])
    opened = read(tmp_path / "run.mcap")
    assert list(opened.batches()) == []
    assert "damaged" in str(opened.damage)


def test_an_attachment_that_says_it_is_longer_than_any_is_left_out(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    write(path, CAST)
    name = b"application/x-cbtui-events"
    data = bytearray(path.read_bytes())
    place = data.index(name) + len(name)
    data[place : place + 8] = b"\xff" * 8
    path.write_bytes(data)
    assert "damaged" in str(read(path).damage)


@pytest.mark.parametrize(
    "data", [commands.encode(commands.RunLine(1, "\x7f")).replace(b"\x7f", b"\xff"), b"\x91" * 5000]
)
def test_bytes_that_are_no_command_are_refused_whatever_is_wrong_with_them(data: bytes) -> None:
    with pytest.raises(msgspec.DecodeError):
        commands.decode(data)


@pytest.mark.parametrize("text", ["\ud800", _DEEP, '{"type":"line","line":1,"text":"\udc9b"}'])
def test_a_text_that_is_no_input_is_refused_whatever_is_wrong_with_it(text: str) -> None:
    with pytest.raises(msgspec.DecodeError):
        commands.input_of(text)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("9" * 5000, float("inf")),
        ("-" + "9" * 5000, float("-inf")),
        ("0x" + "f" * 20, float(16**20)),
        ("-0x" + "f" * 5000, float("-inf")),
        ("9" * 20, 1e20),
        ("0777", 0o777),
    ],
)
def test_an_integer_that_is_too_long_is_a_double_as_in_c(text: str, value: float) -> None:
    assert read_value(text) == value


def test_a_parameter_file_that_no_file_can_be_called_is_refused() -> None:
    with pytest.raises(ArgumentsError, match="there cannot be such a file"):
        parse_arguments(["--ros-args", "--params-file", "a\0b"])


@pytest.mark.parametrize("text", [f"a = {_DEEP}", "a = " + "9" * 5000])
def test_toml_that_python_cannot_hold_is_complained_about(tmp_path: Path, text: str) -> None:
    (tmp_path / "lesson.toml").write_text(text)
    with pytest.raises(BadLesson, match="is not valid TOML"):
        read_lesson(tmp_path)
    (complaint,) = read_text(text, "config.toml").complaints
    assert complaint.startswith("config.toml:")


def test_a_long_name_of_a_constant_is_judged_at_once() -> None:
    with pytest.raises(DefinitionError, match="A" * 40):
        parse(f"int32 {'A' * 40}a=1\n", "my_msgs", "msg", "Mine", origin="Mine.msg")


def test_a_run_may_tell_of_threads_that_never_appeared() -> None:
    run = Run()
    main, node = run.thread("MainThread"), run.node("/node")
    odom = run.subscription(run.exclusive(node), "/odom", "odom", depth=1)
    run.callback(odom, main + 99, 0.5, 0.1)
    told = [
        *run.events,
        ev.MessageDropped(1_000_000_000, odom, 1, 5),
        ev.ProcessEnded(2_000_000_000, 7, "over", 0),
    ]
    timeline = Timeline()
    timeline.extend(told)
    diagnose(timeline)


def test_a_run_may_tell_of_queues_shorter_than_nothing_and_of_numbers_too_large_to_keep() -> None:
    run = Run()
    odom = run.subscription(run.exclusive(run.node("/node")), "/odom", "odom")
    timeline = Timeline()
    timeline.extend([*run.events, ev.EntityReady(1, odom, 1, 2**64 - 1), ev.EntityReady(2, odom, -5, 3)])
    timeline.extend([ev.CallbackStarted(3, odom, 1, 3, 0, -1)])
    assert timeline.queue(odom, 2).depth == -5
    assert timeline.moment(3)


@pytest.mark.parametrize(
    ("file", "content"),
    [
        ("setup.py", b"# \xdb"),
        ("setup.py", b"a = " + b"(" * 5000),
        ("setup.py", b"a = \0"),
        ("setup.cfg", b"[metadata]\nname = \xc2x"),
        ("setup.cfg", b"[options.data_files]\nshare/my_pkg =\n  /etc/*\n"),
        ("setup.cfg", b"[options.data_files]\nshare/my_pkg =\n  ../../*\n"),
    ],
)
def test_the_build_file_of_a_package_is_refused_whatever_is_wrong_with_it(
    tmp_path: Path, file: str, content: bytes
) -> None:
    # Not beside other tests' folders, which programs in these would take for one workspace.
    folder = tmp_path / "workspace" / "my_pkg"
    folder.mkdir(parents=True)
    (folder / "package.xml").write_text("<package><name>my_pkg</name></package>")
    (folder / file).write_bytes(content)
    package = find_packages(folder).package("my_pkg")
    with pytest.raises(PackageError):
        _ = package.share_files
