"""No command hands on to the terminal what somebody else wrote for it to obey."""

from pathlib import Path

import pytest

from cbtui import cli
from tests.safety import hostile
from tests.safety.hostile import HOSTILE, obeyed

_NAME = "\x1b[2J\x9b31m\u202enode\udc9b"


@pytest.fixture
def recording(tmp_path: Path) -> str:
    return str(hostile.recording(tmp_path / "run.mcap"))


def said_by(capsys: pytest.CaptureFixture[str], *words: str) -> str:
    """What a command writes, to its output and as complaints; it says something."""
    try:
        cli.main(list(words))
    except SystemExit as ended:
        assert ended.code == 2  # noqa: PT017 - a command that is refused says why
    said = capsys.readouterr()
    assert said.out + said.err
    return said.out + said.err


def test_hostile_text_is_seen_for_what_it_is() -> None:
    assert {"\x1b", "\x07", "\x9b", "\x9d", "\u202e", "\u200b", "\x08", "\r"} <= obeyed(HOSTILE)
    assert not obeyed("plain µ → 界 text\n")


@pytest.mark.parametrize(
    "words", [["info"], ["replay"], ["compare", "--text", "{}"], ["export", "--svg", "/no/{}/x"]]
)
def test_what_is_told_of_a_recording_is_shown_and_not_obeyed(
    recording: str, capsys: pytest.CaptureFixture[str], words: list[str]
) -> None:
    command, *others = (word.format(recording) for word in words)
    assert not obeyed(said_by(capsys, command, recording, *others))


def test_info_shows_what_it_does_not_obey(recording: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert "␛]52;c;ZXZpbA==␇" in said_by(capsys, "info", recording)


@pytest.mark.parametrize("option", ["svg", "csv", "markdown", "chrome"])
def test_an_export_holds_nothing_that_a_terminal_obeys(recording: str, tmp_path: Path, option: str) -> None:
    assert cli.main(["export", recording, f"--{option}", str(tmp_path / "out")]) == 0
    written = (tmp_path / "out").read_bytes().decode("utf-8").replace("\r\n", "\n")  # CSV's own
    assert "ZXZpbA" in written
    assert not obeyed(written)


def test_an_export_of_calls_has_no_cell_that_a_spreadsheet_reckons_with(tmp_path: Path) -> None:
    from tests.export.examples import small_run

    path = hostile.recording(tmp_path / "run.mcap", small_run())
    assert cli.main(["export", str(path), "--csv", str(tmp_path / "out.csv")]) == 0
    assert "'=cmd|" in (tmp_path / "out.csv").read_text()


@pytest.mark.parametrize(
    "words",
    [
        ["list"],
        ["lint-lesson", "{}/bad-lesson"],
        ["run", "bad-lesson-"],
        ["eject", "{}/out", "--unit", "none"],
        ["start", "bad-lesson-"],
        ["reset", "bad-lesson"],
        ["check", "bad-lesson"],
    ],
)
def test_the_texts_of_a_foreign_lesson_are_shown_and_not_obeyed(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    words: list[str],
) -> None:
    monkeypatch.setenv("CBTUI_LESSONS", str(hostile.lesson(tmp_path).parent))
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    monkeypatch.chdir(tmp_path)
    assert not obeyed(said_by(capsys, *(word.format(tmp_path) for word in words)))


@pytest.mark.parametrize(
    "words",
    [
        ["run", "{}.py"],
        ["open", "{}.py"],
        ["info", "{}"],
        ["replay", "{}"],
        ["export", "{}", "--csv", "x"],
        ["compare", "{}.mcap", "{}.py"],
        ["check", "split-groups", "{}.py"],
        ["grade", "{}"],
        ["--lessons", "{}", "list"],
        ["--config", "{}", "keys"],
        ["--theme", "{}", "keys"],
        ["new-lesson", "{}"],
        ["lint-lesson", "{}"],
        ["eject", "/dev/null/{}"],
        ["explore", "{}.py"],
        ["ros2", "--engine", "1{}"],
        ["{}"],
        ["run", "--for", "{}"],
        ["run", "x.py", "--group", "{}"],
        ["serve", "--public-url", "{}"],
        ["serve", "--", "{}"],
    ],
)
def test_names_on_a_command_line_are_shown_and_not_obeyed(
    capsys: pytest.CaptureFixture[str], words: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert not obeyed(said_by(capsys, *(word.format(_NAME) for word in words)))


@pytest.mark.slow
def test_names_of_learners_files_are_shown_and_not_obeyed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / f"{_NAME}.py").touch()
    (tmp_path / f"={_NAME}").mkdir()
    assert not obeyed(said_by(capsys, "grade", str(tmp_path)))
    table = said_by(capsys, "grade", str(tmp_path), "--csv")
    assert not obeyed(table)
    assert "\n'=" in table


def test_a_configuration_is_complained_about_in_plain_text(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "config.toml"
    path.write_text('[display]\ntheme = "\\u001b[31m\\u202e"\n[keys]\n"\\u009b" = "\\u001b"\n')
    assert not obeyed(said_by(capsys, "--config", str(path), "keys"))


_NODE = f"""
import sys
import rclpy
from rclpy.node import Node

rclpy.init()
node = Node("node")
node.declare_parameter("text", {HOSTILE!r})
node.get_logger().get_child({HOSTILE!r}).warning({HOSTILE!r})
print({HOSTILE!r})
sys.stderr.write({HOSTILE!r} + "\\n")
def fail():
    raise ValueError({HOSTILE!r})
node.create_timer(1.0, fail)
rclpy.spin(node)
"""


def test_what_a_program_logs_prints_and_raises_is_shown_and_not_obeyed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / f"{_NAME.removesuffix(chr(0xDC9B))}.py"
    path.write_text(_NODE)
    lines = [word for line in ("param get /node text", "param dump /node") for word in ("--at", "0.5", line)]
    said = said_by(capsys, "run", str(path), "--clock", "virtual", "--speed", "max", "--for", "2", *lines)
    assert said.count("ZXZpbA") >= 5
    assert not obeyed(said)
