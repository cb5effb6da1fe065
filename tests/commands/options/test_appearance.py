"""Keys and looks on the command line: what is taken over, what is refused, what a terminal gets by itself."""

import os
import pty
import subprocess
import sys
from io import StringIO
from pathlib import Path

import pytest

from cbtui import cli
from cbtui.commands import console
from cbtui.commands.options.appearance import Appearance, appearance, given
from cbtui.keys.config import read_text
from cbtui.terminal.capabilities import BROWSER_DRIVER, charset_of


def parsed(*words: str) -> Appearance:
    return appearance(cli._parser().parse_args(words))


@pytest.fixture(autouse=True)
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Whoever runs the tests may have a configuration."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    monkeypatch.setenv("LC_ALL", "C.UTF-8")
    monkeypatch.setenv("TERM", "xterm-256color")
    folder = tmp_path / "cbtui"
    folder.mkdir()
    return folder


def test_what_keys_prints_is_a_configuration_that_changes_nothing(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert cli.main(["keys"]) == 0
    printed = capsys.readouterr().out
    config, complaints = read_text(printed, "config.toml")
    assert complaints == []
    (tmp_path / "copy.toml").write_text(printed)
    assert cli.main(["keys", "--config", str(tmp_path / "copy.toml")]) == 0
    assert capsys.readouterr().out == printed
    assert (config.theme, config.charset) == ("dark", "auto")


def test_keys_prints_those_in_force(capsys: pytest.CaptureFixture[str], home: Path) -> None:
    (home / "config.toml").write_text('[keys]\nlesson.pause = "f5"\nlesson.resume = "f5"\n')
    assert cli.main(["keys"]) == 0
    assert 'lesson.pause = "f5"' in capsys.readouterr().out


def test_a_wrong_configuration_that_was_named_is_refused(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    (tmp_path / "mine.toml").write_text('[keys]\nlesson.pause = "spcae"\n')
    with pytest.raises(SystemExit) as ended:
        cli.main(["keys", "--config", str(tmp_path / "mine.toml")])
    assert ended.value.code == 2
    [line] = capsys.readouterr().err.splitlines()
    assert line == "cbtui: mine.toml:2: 'spcae' is not the name of a key; did you mean 'space'?"


def test_a_wrong_configuration_of_ones_own_is_told_in_the_console(home: Path) -> None:
    (home / "config.toml").write_text('[keys]\nlesson.pause = "spcae"\n[display]\ntheme = "light"\n')
    look = parsed()
    assert look.complaints == ["config.toml:2: 'spcae' is not the name of a key; did you mean 'space'?"]
    assert look.theme == "light"


def test_an_option_goes_before_the_configuration(home: Path) -> None:
    (home / "config.toml").write_text('[display]\ntheme = "light"\ncharset = "block"\n')
    assert parsed()[:3] == ("block", "block", "light")
    assert parsed("--theme", "high-contrast", "--charset", "ascii")[:3] == ("ascii", "ascii", "high-contrast")


def test_an_option_may_stand_before_the_command_or_after_it() -> None:
    assert parsed("--theme", "light", "open", "split-groups").theme == "light"
    assert parsed("open", "split-groups", "--theme", "light").theme == "light"
    options = cli._parser().parse_args(["--charset", "block", "serve", "--theme", "light"])
    assert given(options) == ["--charset", "block", "--theme", "light"]


@pytest.mark.parametrize("command", [[], ["list"], ["run", "split-groups"]])
def test_an_unknown_theme_is_refused(command: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        cli.main(["--theme", "drak", *command])
    assert ended.value.code == 2
    assert capsys.readouterr().err == "cbtui: there is no theme 'drak'; did you mean 'dark'?\n"


@pytest.mark.parametrize(
    ("environment", "utf8_mode", "charset"),
    [
        ({"LANG": "en_GB.UTF-8"}, False, "braille"),
        ({"LANG": "C.utf8"}, False, "braille"),
        ({"LANG": "C"}, False, "ascii"),
        ({"LANG": "de_DE.ISO-8859-1"}, False, "ascii"),
        ({}, False, "ascii"),
        ({"LC_ALL": "C", "LANG": "en_GB.UTF-8"}, False, "ascii"),
        ({"LC_ALL": "", "LC_CTYPE": "en_GB.UTF-8", "LANG": "C"}, False, "braille"),
        # As Python leaves the environment when the locale is C, or is not installed.
        ({"LC_CTYPE": "C.UTF-8", "LANG": "C"}, True, "ascii"),
        ({"LC_CTYPE": "C.UTF-8", "LANG": "en_GB.UTF-8"}, True, "braille"),
        ({"LANG": "en_GB.UTF-8", "TERM": "linux"}, False, "ascii"),
        ({"LANG": "C", "TEXTUAL_DRIVER": BROWSER_DRIVER}, False, "braille"),
    ],
)
def test_the_charset_is_what_the_terminal_is_sure_to_have(
    environment: dict[str, str], utf8_mode: bool, charset: str
) -> None:
    assert charset_of(environment, utf8_mode) == charset


def test_a_terminal_that_cannot_place_its_cursor_is_refused_in_one_line() -> None:
    ours, theirs = pty.openpty()
    with os.fdopen(ours, "rb", buffering=0) as screen:
        command = [sys.executable, "-m", "cbtui", "open", "split-groups"]
        environment = os.environ | {"TERM": "dumb"}
        done = subprocess.run(
            command, stdin=theirs, stdout=theirs, stderr=theirs, env=environment, check=False
        )
        os.close(theirs)
        assert done.returncode == 2
        said = screen.read(4096).decode().splitlines()
    assert said == ["cbtui: this terminal (TERM=dumb) cannot place its cursor; use cbtui run"]


@pytest.mark.parametrize(("term", "said"), [("xterm-256color", "opening ...\r"), ("dumb", "")])
def test_that_something_is_opened_is_said_before_the_looks_are_read(
    monkeypatch: pytest.MonkeyPatch, term: str, said: str
) -> None:
    """Reading them imports Textual, which takes longer than one should look at nothing."""
    terminal = StringIO()
    monkeypatch.setattr(terminal, "isatty", lambda: True)
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setenv("TERM", term)
    written: list[str] = []

    def read(_options: object) -> Appearance:
        written.append(terminal.getvalue())
        raise SystemExit(2)

    monkeypatch.setattr(console, "appearance", read)
    for words in ([], ["open", "split-groups"]):
        terminal.truncate(0)
        terminal.seek(0)
        with pytest.raises(SystemExit):
            cli.main(words)
    assert written == [said, said]
