"""Each row of the table of the standard library does on virtual time what the table says."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any, TypeAlias

import pytest

from tests.clock.stdlib_table import PAGE, PRELUDE, ROWS, Does, Row, page_with, table

_SLACK = 0.5
"""Seconds by which a run that follows the wall may have been behind it before."""
_HARNESS = """
import asyncio, json, os, sys, traceback
from time import monotonic as real_monotonic
import sim.engine.process
from sim.clock import VirtualClock
from sim.clock.asyncio_loops import ProgramLoops
from sim.clock.stdlib import live_on
from sim.engine.programs.children import refuse_children

told = []
clock = VirtualClock()
refuse_children()
live_on(clock, told.append)
ProgramLoops(clock).install()
exec(sys.argv[2])
for place, row in enumerate(json.loads(sys.argv[1])):
    told.clear()
    began, really_began, error = clock.now(), real_monotonic(), ""
    try:
        exec(row, dict(globals()))
    except BaseException as raised:
        error = "".join(traceback.format_exception(raised))
    took, really_took = (clock.now() - began) / 1e9, real_monotonic() - really_began
    print("\\n" + json.dumps([place, took, really_took, told[:1], error]), flush=True)
os._exit(0)
"""

Came: TypeAlias = list[Any]


@pytest.fixture(scope="module")
def came() -> dict[str, Came]:
    """What came of each row: seconds it took, real ones too, what was told of it, and the error."""
    done = subprocess.run(
        [sys.executable, "-c", _HARNESS, json.dumps([row.body for row in ROWS]), PRELUDE],
        capture_output=True,
        text=True,
        cwd=Path(__file__).parents[2],
        check=False,
    )
    lines = [json.loads(line) for line in done.stdout.splitlines() if line.startswith("[")]
    assert len(lines) == len(ROWS), done.stderr
    return {ROWS[place].call: rest for place, *rest in lines}


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row.call)
def test_a_row_does_what_the_table_says(row: Row, came: dict[str, Came]) -> None:
    seconds, real_seconds, told, error = came[row.call]
    if row.does is Does.REFUSED:
        assert "use --clock real" in error
        return
    assert error == ""
    assert bool(told) is (row.does in {Does.HOLDS, Does.NEW})
    if row.does is Does.HOLDS:
        assert row.takes <= seconds <= real_seconds + _SLACK
    else:
        assert seconds == pytest.approx(row.takes, abs=1e-8)


def test_the_page_has_the_table() -> None:
    assert PAGE.read_text(encoding="utf-8") == page_with(table())
