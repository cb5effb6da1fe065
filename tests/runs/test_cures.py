"""A cure is offered only if the run with it has the problem no more; tried on beginners' programs."""

from dataclasses import replace
from pathlib import Path
from threading import Event

import pytest

from cbtui.engines.follow import GivenUpError
from cbtui.runs.judged.cures import changes_of, helps, problem_of
from cbtui.runs.setup.changes import Changes
from sim.diagnosis import Finding, diagnose
from sim.diagnosis.cures import Remedy
from sim.trace.timeline import Timeline
from tests.support.engine_runs import SECOND, program_setup, run_to_end

PROGRAMS = Path(__file__).parents[1] / "diagnosis" / "beginners"


def first_problem(program: str) -> tuple[Finding, Remedy, Timeline]:
    timeline = run_to_end(program_setup(PROGRAMS / f"{program}.py", 3.0)).timeline
    found = diagnose(timeline)[0]
    return found, found.rule.explain(found, timeline).remedy, timeline


def tried(program: str, remedy: Remedy | None = None) -> bool:
    found, offered, timeline = first_problem(program)
    setup = program_setup(PROGRAMS / f"{program}.py", 3.0)
    changes = changes_of(remedy or offered, Changes(), timeline)
    assert changes is not None
    return helps(problem_of(found, timeline), setup, changes.applied(setup), 3 * SECOND, Event())


@pytest.mark.parametrize("program", ["call_in_timer", "rate_sleep", "held_group", "sleep_in_service"])
def test_a_cure_that_is_offered_ends_the_problem(program: str) -> None:
    assert tried(program)


def test_threads_alone_do_not_open_a_held_group() -> None:
    assert not tried("held_group", Remedy(threads=6))


def test_what_only_an_edit_cures_has_nothing_to_be_tried() -> None:
    _, remedy, timeline = first_problem("lock_across_callbacks")
    assert changes_of(remedy, Changes(), timeline) is None
    assert changes_of(replace(remedy, threads=2), Changes(), timeline) == Changes(threads=2)


def test_a_trial_can_be_given_up() -> None:
    given_up = Event()
    given_up.set()
    setup = program_setup(PROGRAMS / "held_group.py", 3.0)
    with pytest.raises(GivenUpError):
        helps(("group-starvation", "", ""), setup, setup, 3 * SECOND, given_up)
