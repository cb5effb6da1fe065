"""A comparison says whether what hung in one run hangs in the other; on runs of beginners' programs."""

from functools import cache
from pathlib import Path

from cbtui.runs.judged.hangs import ComparedHangs
from cbtui.runs.setup.changes import Changes
from sim.trace.timeline import Timeline
from tests.support.engine_runs import program_setup, run_to_end

PROGRAMS = Path(__file__).parents[1] / "diagnosis" / "beginners"


@cache
def run_of(program: str, changes: Changes | None = None, seconds: float = 6.0) -> Timeline:
    setup = program_setup(PROGRAMS / f"{program}.py", seconds)
    return run_to_end(setup if changes is None else changes.applied(setup)).timeline


def test_a_deadlock_is_gone_or_still_there_or_new() -> None:
    stuck, well = run_of("call_in_timer"), run_of("sleep_in_service")
    assert ComparedHangs(stuck, well).told() == "The deadlock is gone."
    assert ComparedHangs(stuck, stuck).told() == "The deadlock is still there."
    assert ComparedHangs(well, stuck).told() == "Run B has a deadlock that run A has not."
    assert ComparedHangs(well, well).told() == ""
    assert (
        ComparedHangs(stuck, run_of("lock_across_callbacks")).told()
        == "The deadlock is gone, but run B has another one."
    )


def test_a_wait_without_end_that_is_no_deadlock_is_a_hang() -> None:
    assert ComparedHangs(run_of("wait_for_service"), run_of("sleep_in_service")).told() == "The hang is gone."


def test_nothing_is_said_of_a_run_that_has_not_come_to_the_deadlock() -> None:
    early = run_of("sleep_in_service", seconds=0.2)
    assert ComparedHangs(run_of("call_in_timer"), early).told() == ""
