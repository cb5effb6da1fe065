"""Runs a program as a learner types it, on virtual time."""

import textwrap
from pathlib import Path

from sim.engine.setup import ProgramSetup, RunSetup
from sim.trace.events import Printed
from tests.support.engine_runs import SECOND, Run, run_to_end


def run(folder: Path, program: str, *, seconds: float = 10) -> Run:
    """A run of a program, to its end or for some seconds of its time."""
    file = folder / "program.py"
    file.write_text(textwrap.dedent(program))
    return run_to_end(
        RunSetup(
            title="program",
            programs=(ProgramSetup(str(file), ()),),
            speed=None,
            until=round(seconds * SECOND),
        )
    )


def printed(folder: Path, program: str, *, seconds: float = 10, error: bool = False) -> list[str]:
    """The lines that a program prints."""
    ended = run(folder, program, seconds=seconds)
    wrong = [event.text for event in ended.events if isinstance(event, Printed) and event.error]
    said = [event.text for event in ended.events if isinstance(event, Printed) and not event.error]
    assert error or not wrong, "\n".join(wrong)
    return wrong if error else said
