"""What commands print has colours on a terminal, where nobody asked for none."""

import io

import pytest

from cbtui.text.colours import Colour, coloured, with_coloured_signs


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.fixture(autouse=True)
def environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("NO_COLOR", raising=False)
    monkeypatch.setenv("TERM", "xterm-256color")


def test_a_sign_at_the_beginning_of_a_line_is_coloured_on_a_terminal() -> None:
    text = "✓ well ✓\n    expected!\n  ! a problem\n✗ bad\n!ok"
    told = "\x1b[32m✓\x1b[0m well ✓\n    expected!\n\x1b[33m  !\x1b[0m a problem\n\x1b[31m✗\x1b[0m bad\n!ok"
    assert with_coloured_signs(text, Terminal()) == told


def test_a_pipe_has_no_colours() -> None:
    assert coloured("late", Colour.WARNING, io.StringIO()) == "late"


@pytest.mark.parametrize(("name", "value"), [("NO_COLOR", "1"), ("TERM", "dumb")])
def test_who_wants_no_colours_has_none(monkeypatch: pytest.MonkeyPatch, name: str, value: str) -> None:
    monkeypatch.setenv(name, value)
    assert coloured("late", Colour.WARNING, Terminal()) == "late"
