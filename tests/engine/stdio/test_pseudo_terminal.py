"""Where the system gives no pseudo-terminal, programs still read lines, and the end of the input."""

import os
from pathlib import Path

import pytest

from sim.engine.stdio.pseudo_terminal import PseudoTerminal
from sim.trace.events import Reading


def test_without_a_pseudo_terminal_a_pipe_hands_on_lines(monkeypatch: pytest.MonkeyPatch) -> None:
    def none_left() -> tuple[int, int]:
        raise FileNotFoundError(2, "out of pty devices")

    monkeypatch.setattr(os, "openpty", none_left)
    pair = PseudoTerminal()
    assert pair.mode() is Reading.LINES
    assert pair.is_meant_by(os.fstat(pair.near))
    with Path(os.devnull).open("rb") as other:
        assert not pair.is_meant_by(os.fstat(other.fileno()))
    pair.type("Ada\nand")
    assert pair.feed(is_last=True)
    assert os.read(pair.near, 100) == b"Ada\n"
    assert pair.feed(is_last=True)
    assert os.read(pair.near, 100) == b"and"
    pair.end()
    pair.end()
    assert os.read(pair.near, 100) == b""
