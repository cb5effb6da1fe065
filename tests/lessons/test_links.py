"""A problem in a lesson's run leads to that lesson, or to one that shows the same."""

import pytest

from lessons.catalogue import find, lesson_on
from sim.diagnosis import Weight, diagnose
from tests.support.engine_runs import run_lesson


@pytest.mark.slow
@pytest.mark.parametrize(
    ("lesson", "calls", "shown_by"),
    [
        ("shared-group", (), "single-thread"),
        ("no-groups-at-all", (2.55,), "no-groups-at-all"),
        ("reentrant-2-threads", (2.55, 2.6, 2.65), "reentrant-2-threads"),
        ("reentrant-1-thread", (2.55,), "reentrant-1-thread"),
        ("three-cures", (), "three-cures"),
        ("service-in-a-service", (2.5,), "service-in-a-service"),
        ("await-keeps-its-group", (2.5,), "await-keeps-its-group"),
        ("cancel-never-served", (2.5,), "cancel-never-served"),
        ("lock-or-group", (), "lock-or-group"),
        ("nodes-in-one-executor", (2.5,), "nodes-in-one-executor"),
    ],
)
def test_a_problem_of_a_lesson_leads_to_the_lesson_on_it(
    lesson: str, calls: tuple[float, ...], shown_by: str
) -> None:
    timeline = run_lesson(lesson, 12.0, *calls).timeline
    problems = [each for each in diagnose(timeline) if each.weight_in(timeline) is Weight.PROBLEM]
    assert problems
    assert {lesson_on(each.rule.kind(each, timeline)) for each in problems} == {find(shown_by)}
