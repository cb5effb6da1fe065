"""The progress of a command where standard error is no terminal."""

import pytest

from cbtui.terminal.progress_line import ProgressLine


def test_who_reads_no_terminal_is_told_every_few_seconds_how_far_it_has_come(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    now = 0.0
    monkeypatch.setattr("cbtui.terminal.progress_line.time.monotonic", lambda: now)
    with ProgressLine() as line:
        for now in (1.0, 4.9, 5.5, 9.9, 10.4, 11.5, 30.0):
            line.show(f"at {now:.1f} s")
    assert capsys.readouterr().err == "at 5.5 s\nat 11.5 s\nat 30.0 s\n"
