"""A cure is offered only if the run with it has the problem no more; tried on beginners' programs."""

from dataclasses import replace
from pathlib import Path
from threading import Event

import msgspec
import pytest

from cbtui.engines.follow import GivenUpError
from cbtui.runs.judged.cures import changes_of, helps, problem_of, problems_in, with_inputs
from cbtui.runs.setup.changes import Changes
from sim.diagnosis import Finding, diagnose
from sim.diagnosis.cures import Remedy
from sim.engine.commands import CallService, input_text
from sim.engine.setup import TimedInput
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
    before, after = (problems_in(each, 3 * SECOND, Event()) for each in (setup, changes.applied(setup)))
    return helps(problem_of(found, timeline), before, after)


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
        problems_in(setup, 3 * SECOND, given_up)


def test_a_trial_tells_how_far_it_is() -> None:
    told: list[int] = []
    problems_in(program_setup(PROGRAMS / "held_group.py", 3.0), 3 * SECOND, Event(), told.append)
    assert told == sorted(told)
    assert told[-1] == 3 * SECOND


def test_no_cure_helps_a_run_that_does_not_come_to_its_end() -> None:
    problem = ("group-starvation", "", "")
    assert helps(problem, {problem: True}, {})
    assert not helps(problem, None, {})
    assert not helps(problem, {problem: True}, None)


def test_the_calls_of_a_run_belong_to_its_trial(tmp_path: Path) -> None:
    text = (PROGRAMS / "sleep_in_service.py").read_text().replace("self.create_timer(2.0, self.close)", "")
    program = tmp_path / "served.py"
    program.write_text(text)
    setup = program_setup(program, 3.0)
    assert problems_in(setup, 3 * SECOND, Event()) == {}
    called = TimedInput(SECOND // 2, input_text(CallService(None, True)))
    found = problems_in(with_inputs(setup, (called,)), 3 * SECOND, Event())
    assert [rule for rule, _, _ in found or {}] == ["group-starvation"]


def test_a_call_of_a_run_before_is_made_on_the_real_clock_too(tmp_path: Path) -> None:
    called = TimedInput(SECOND // 10, input_text(CallService("/gripper", True)))
    setup = with_inputs(program_setup(PROGRAMS / "sleep_in_service.py", 1.0), (called,))
    timeline = run_to_end(msgspec.structs.replace(setup, clock="real", speed=1.0)).timeline
    assert [call.service for call in timeline.calls if call.caller == 0] == ["/gripper"]
