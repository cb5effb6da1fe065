"""A trial's verdict on a cure, from what the runs without and with it showed."""

from dataclasses import replace

import pytest

from cbtui.runs.judged.cures import TriedRun, Verdict, judged
from tests.support.engine_runs import SECOND


def test_no_cure_helps_where_a_run_does_not_come_to_what_was_found_or_ends_too_soon() -> None:
    problem = ("group-starvation", "", "")
    bad, good = TriedRun({problem: True}), TriedRun({})
    assert judged(problem, bad, good).helps
    assert not judged(problem, good, good).helps
    assert not judged(problem, bad, replace(good, is_whole=False)).helps
    assert not judged(problem, bad, bad).helps


def test_a_run_that_took_too_long_is_judged_by_what_it_came_to() -> None:
    problem = "self-made-deadlock", "a", "b"
    before = TriedRun({problem: True}, end=40 * SECOND, since={problem: 20 * SECOND})
    far, near = (TriedRun({}, is_whole=False, is_cut=True, end=each * SECOND) for each in (23, 21))
    assert judged(problem, before, far).helps
    assert judged(problem, before, near).helps is None


def test_a_crash_is_worse_than_what_comes_to_light_without_it() -> None:
    crash, slow = ("program-raised", "", ""), ("group-starvation", "", "")
    assert judged(crash, TriedRun({crash: False}, is_whole=False), TriedRun({slow: False})).helps


def test_a_problem_in_the_place_of_the_one_that_is_gone_is_named() -> None:
    slow, stuck = ("group-starvation", "", ""), ("self-made-deadlock", "", "")
    after = TriedRun({stuck: True}, names={stuck: "deadlock"})
    assert judged(slow, TriedRun({slow: False}), after) == Verdict(False, "deadlock")
    lesser = TriedRun({slow: False}, names={slow: "long loop"})
    assert judged(stuck, TriedRun({stuck: True}), lesser) == Verdict(True, "long loop")


def test_to_end_an_exception_helps_whatever_the_program_does_wrong_then() -> None:
    crash, stuck = ("program-raised", "", ""), ("self-made-deadlock", "", "")
    before = TriedRun({crash: False}, is_whole=False, end=1)
    after = TriedRun({stuck: True}, names={stuck: "deadlock"}, end=9)
    assert judged(crash, before, after) == Verdict(True, "deadlock")
    assert judged(crash, before, replace(after, is_whole=False)) == Verdict(True, "deadlock")
    assert not judged(crash, before, replace(after, is_whole=False, end=1)).helps


def test_to_end_a_problem_helps_though_a_callback_that_now_runs_has_one_of_its_own() -> None:
    silent, slow = ("qos-mismatch", "hear", "hear"), ("group-starvation", "tick", "hear")
    before = TriedRun({silent: False}, calls={"hear": 0, "tick": 20})
    after = TriedRun({slow: False}, names={slow: "group starvation"}, calls={"hear": 9, "tick": 20})
    assert judged(silent, before, after) == Verdict(True, "group starvation")
    had_run = replace(before, calls={"hear": 1, "tick": 20})
    assert not judged(silent, had_run, after).helps
    assert not judged(silent, before, replace(after, problems={slow: True})).helps, "that lasts for ever"


@pytest.mark.parametrize(
    ("now", "again", "instead"),
    [
        (1, True, "pick is not called again"),
        (1, False, "pick is called less often, 1 time in place of 3"),
        (3, False, ""),
        (4, True, ""),
    ],
)
def test_a_cure_after_which_a_callback_does_its_work_no_more_does_not_help(
    now: int, again: bool, instead: str
) -> None:
    problem = ("service-never-comes", "pick", "pick")
    before, after = TriedRun({problem: True}, calls={"pick": 3}), TriedRun({}, calls={"pick": now})
    assert judged(problem, before, after, again=again) == Verdict(not instead, instead)


def test_what_was_an_effect_of_the_problem_is_no_worse_one_in_its_place() -> None:
    starved, lost = ("group-starvation", "", ""), ("dropped-messages", "decide", "hear")
    before = TriedRun({starved: False}, effects=frozenset({("dropped-messages", "hear")}))
    assert judged(starved, before, TriedRun({lost: False})).helps
    for effects in ((), {("dropped-messages", "listen")}):
        others = replace(before, effects=frozenset(effects))
        assert not judged(starved, others, TriedRun({lost: False})).helps, "another callback loses now"
