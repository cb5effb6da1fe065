"""Every lesson is judged on real ROS 2 as on the model: its predictions, its solution and its starter.

The runs take as long as the lessons' runs do: half an hour for all, by ``pytest -m bulk`` of this file. A few
short ones are among the slow tests.
"""

import ast
from importlib.util import find_spec
from typing import Any

import pytest

from cbtui.learning.outcome import OutcomeRun, PredictionOutcome, observe_engine
from cbtui.runs.judged.checking import check
from lessons.catalogue import lessons
from lessons.judge import Judge
from lessons.lesson import Lesson
from sim.engine.setup import RealRos
from tests.real.programs import needs_ros

pytestmark = needs_ros

_PREDICTED = ("service-in-a-service", "one-queue-for-all")
_SOLVED = ("rate-sleep-in-a-callback",)


def _cases(*, exercises: bool) -> list[Any]:
    """The lessons, or those with an exercise: all of whose imports are found beside this rclpy."""
    short = _SOLVED if exercises else _PREDICTED
    return [
        pytest.param(each, id=each.id, marks=pytest.mark.slow if each.id in short else pytest.mark.bulk)
        for each in lessons()
        if (each.exercise is not None or not exercises) and all(map(find_spec, _imports(each)))
    ]


def _imports(lesson: Lesson) -> set[str]:
    """The packages that a lesson's node imports: the wheels have no tf2, and no example_interfaces."""
    found = (
        each.names[0].name if isinstance(each, ast.Import) else each.module or ""
        for each in _statements(lesson)
    )
    return {name.partition(".")[0] for name in found}


def _statements(lesson: Lesson) -> list[ast.Import | ast.ImportFrom]:
    tree = ast.parse(lesson.node_path.read_text())
    return [each for each in tree.body if isinstance(each, ast.Import | ast.ImportFrom)]


@pytest.mark.parametrize("lesson", _cases(exercises=False))
def test_the_right_answers_are_right(lesson: Lesson) -> None:
    outcome = OutcomeRun(lesson, observe_engine, RealRos()).run()
    right = tuple(prediction.right for prediction in lesson.predictions)
    reason = lesson.setup.not_on_ros2
    assert outcome == (
        PredictionOutcome(trouble=reason) if reason else PredictionOutcome(right, is_real=True)
    )


@pytest.mark.parametrize("lesson", _cases(exercises=True))
def test_the_solution_passes_and_the_starter_fails(lesson: Lesson) -> None:
    assert lesson.solution_path is not None
    assert lesson.starter_path is not None
    judge = Judge(lesson)
    solution = check(lesson, judge, lesson.solution_path, real=RealRos())
    assert [each.verdict.seen for each in solution.judged if not each.verdict.passed] == []
    assert solution.good
    assert not check(lesson, judge, lesson.starter_path, real=RealRos()).good
