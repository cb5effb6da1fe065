"""``--screen-reader``: the console in lines, on a pipe as on a terminal."""

import os
import pty
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from cbtui.cli import main
from cbtui.screens.linear.keyboard import KeyReader
from sim.recording import RecordingMetadata
from tests.recording.files import write
from tests.trace.samples import FULL


@contextmanager
def standard_input(descriptor: int, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    with os.fdopen(descriptor) as stream:
        monkeypatch.setattr(sys, "stdin", stream)
        yield


def piped(text: str) -> int:
    """A pipe's end that gives a text, and then its end."""
    reading, writing = os.pipe()
    os.write(writing, text.encode())
    os.close(writing)
    return reading


@pytest.mark.slow
def test_a_lesson_is_run_in_lines_until_it_is_left(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with standard_input(piped("call-in-a-callback\n3\n1\n1\nq\n"), monkeypatch):
        assert main(["--screen-reader"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert "1: Single thread, single-thread" in lines
    assert "The run begins. ? tells the keys, q leaves." in lines


def test_recordings_are_told_and_compared_in_lines(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path = str(tmp_path / "run.mcap")
    write(tmp_path / "run.mcap", FULL, RecordingMetadata(title="full", clock="virtual"))
    with standard_input(piped("G\n0\n,\n"), monkeypatch):
        assert main(["replay", path, "--screen-reader"]) == 0
    assert "nothing has happened yet" in capsys.readouterr().out
    assert main(["compare", path, path, "--screen-reader"]) == 0
    assert "calls: run A 1, run B 1, same" in capsys.readouterr().out.splitlines()


@pytest.mark.slow
def test_a_puzzle_is_played_in_lines(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with standard_input(piped("1\n1\n"), monkeypatch):
        assert main(["open", "closed-meanwhile", "--screen-reader"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert "2: main, line 28 (MainThread)" in lines
    assert "Choice 3, 0 moves. Who goes on?" in lines


def test_arrows_are_no_other_keys(monkeypatch: pytest.MonkeyPatch) -> None:
    typed: list[str | None] = []
    with standard_input(piped("\x1b[Da\x1bOB\x1b[1;5Cb\n"), monkeypatch):
        keyboard = KeyReader()
        keyboard.give = typed.append
        keyboard.read()
    assert typed == ["ab", None]


@pytest.mark.slow
def test_an_exercise_is_opened_in_lines_by_the_setting_in_the_configuration(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    config = tmp_path / "c.toml"
    config.write_text('[display]\nscreen_reader = "on"\n')
    monkeypatch.chdir(tmp_path)
    with standard_input(piped("q\n"), monkeypatch):
        assert main(["open", "split-groups", "--exercise", "--config", str(config)]) == 0
    assert f"Edit {tmp_path / 'split_groups.py'}; e checks it then." in capsys.readouterr().out


def test_keys_of_a_terminal_come_one_by_one_and_lines_when_they_are_wanted(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    person, terminal = pty.openpty()
    typed: list[str | None] = []
    with standard_input(terminal, monkeypatch):
        keyboard = KeyReader()
        keyboard.take_lines(wanted=False)
        keyboard.give = typed.append
        os.write(person, b"s.\x04")
        keyboard.read()
        assert typed == ["s", ".", None]
        keyboard.take_lines(wanted=True)
        os.write(person, b"ros2 topi\x7fic list\n\x04")
        keyboard.read()
        assert typed[3:] == ["ros2 topic list", None]
    os.close(person)
