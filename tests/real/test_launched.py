"""How programs on real ROS 2 end, of which no probe need tell."""

import os
import time
from collections.abc import Callable
from pathlib import Path
from selectors import DefaultSelector

import pytest

from sim.real.launched import LaunchedPrograms, Outcome

_LIMIT = 30.0
"""Real seconds for a shell to print a word, or to end."""


def outcome_of(folder: Path, script: str, do: Callable[[LaunchedPrograms], object]) -> Outcome:
    """How a shell script ended to which something was done as soon as it had printed a line."""
    printed: list[str] = []
    with DefaultSelector() as selector:
        programs = LaunchedPrograms(
            selector,
            folder,
            [["sh", "-c", script]],
            os.environ,
            lambda *_, **__: None,
            lambda _: None,
            lambda text, _error, _process: printed.append(text),
        )
        programs.start()
        ends_at, done = time.monotonic() + _LIMIT, False
        while programs.any_run and time.monotonic() < ends_at:
            for key, _ in selector.select(0.01):
                key.data()
            programs.look()
            if printed and not done:
                done = True
                do(programs)
        return programs.outcome()


@pytest.mark.parametrize(
    ("script", "do", "outcome"),
    [
        ("trap '' INT; echo x; sleep 60", LaunchedPrograms.kill, Outcome("it was stopped", failed=False)),
        ("echo x; exec sleep 60", LaunchedPrograms.interrupt, Outcome("it was stopped", failed=False)),
        ("echo x; kill -9 $$", id, Outcome("the program crashed by SIGKILL", failed=True)),
        ("echo x; exit 3", id, Outcome("the program ended with exit code 3", failed=True)),
        ("echo x", id, Outcome("the program returned", failed=False)),
    ],
)
def test_only_what_a_program_did_by_itself_counts_as_its_failure(
    tmp_path: Path, script: str, do: Callable[[LaunchedPrograms], object], outcome: Outcome
) -> None:
    assert outcome_of(tmp_path, script, do) == outcome
