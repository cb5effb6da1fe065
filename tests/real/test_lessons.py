"""Every lesson is judged on real ROS 2 as on the model: its predictions, its solution and its starter.

The runs take as long as the lessons' runs do, so all of this takes half an hour.
"""

import pytest

from cbtui.learning.outcome import OutcomeRun, PredictionOutcome, observe_engine
from cbtui.runs.judged.checking import check
from lessons.catalogue import lessons
from lessons.judge import Judge
from lessons.lesson import Lesson
from sim.engine.setup import RealRos
from tests.real.programs import needs_ros

pytestmark = [needs_ros, pytest.mark.slow]


@pytest.mark.parametrize("lesson", lessons(), ids=lambda lesson: lesson.id)
def test_the_right_answers_are_right(lesson: Lesson) -> None:
    outcome = OutcomeRun(lesson, observe_engine, RealRos()).run()
    right = tuple(prediction.right for prediction in lesson.predictions)
    assert outcome == PredictionOutcome(right, is_real=True)


@pytest.mark.parametrize(
    "lesson", [each for each in lessons() if each.exercise is not None], ids=lambda lesson: lesson.id
)
def test_the_solution_passes_and_the_starter_fails(lesson: Lesson) -> None:
    assert lesson.solution_path is not None
    assert lesson.starter_path is not None
    judge = Judge(lesson)
    solution = check(lesson, judge, lesson.solution_path, real=RealRos())
    assert [each.verdict.seen for each in solution.judged if not each.verdict.passed] == []
    assert solution.good
    assert not check(lesson, judge, lesson.starter_path, real=RealRos()).good
