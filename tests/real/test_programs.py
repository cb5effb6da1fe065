"""How programs on real ROS 2 end, of which no probe need tell."""

import os
import shlex
import sys
import time
from collections.abc import Callable
from pathlib import Path
from selectors import DefaultSelector

import pytest

from sim.engine.failures.cause import Cause
from sim.interpreter.safe_path import without_current_folder
from sim.real.programs import Program, Start

_LIMIT = 30.0
"""Real seconds for a shell to print a word, or to end."""


def outcome_of(script: str, do: Callable[[Program], object]) -> Cause:
    """How a shell script ended to which something was done as soon as it had printed a line."""
    printed: list[str] = []
    with DefaultSelector() as selector:
        program = Program(
            selector,
            Start(["sh", "-c", script], os.environ),
            "script",
            0,
            lambda *_, **__: None,
            lambda text, _error, _process: printed.append(text),
        )
        ends_at, done = time.monotonic() + _LIMIT, False
        while not program.has_ended and time.monotonic() < ends_at:
            for key, _ in selector.select(0.01):
                key.data()
            if printed and not done:
                done = True
                do(program)
        return program.outcome()


@pytest.mark.parametrize(
    ("script", "do", "outcome"),
    [
        ("trap '' INT; echo x; sleep 60", Program.kill, Cause("it was stopped", failed=False)),
        ("echo x; exec sleep 60", Program.interrupt, Cause("it was stopped", failed=False)),
        ("echo x; kill -9 $$", id, Cause("the program crashed with SIGKILL", failed=True)),
        ("echo x; exit 3", id, Cause("the program ended with exit code 3", failed=True)),
        ("echo x", id, Cause("the program returned", failed=False)),
    ],
)
def test_only_what_a_program_did_by_itself_counts_as_its_failure(
    script: str, do: Callable[[Program], object], outcome: Cause
) -> None:
    assert outcome_of(script, do) == outcome


def test_a_program_imports_the_modules_beside_it(tmp_path: Path) -> None:
    (tmp_path / "beside.py").touch()
    program = tmp_path / "program.py"
    program.write_text("import beside\n")
    with without_current_folder():  # as an engine is started
        outcome = outcome_of(shlex.join([sys.executable, str(program)]), id)
    assert outcome == Cause("the program returned", failed=False)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("x = 1\nx = {", "program.py:2: '{' was never closed"),
        ("import os\nos.nothing()", "program.py:2: the program raised AttributeError: module 'os' has no "),
        ("import json\njson.loads('')", "program.py:2: the program raised json.decoder.JSONDecodeError: "),
        ("import sys\nsys.exit('no robot: none')", "the program ended with exit code 1"),
    ],
)
def test_an_exception_before_rclpy_is_imported_is_told_with_its_line(
    tmp_path: Path, text: str, sentence: str
) -> None:
    program = tmp_path / "program.py"
    program.write_text(text)
    outcome = outcome_of(shlex.join([sys.executable, str(program)]), id)
    assert outcome.failed
    assert outcome.reason.startswith(sentence)
