"""The Python beside a lesson: what is read off a run with it, and what is said when it is at fault."""

import shutil
from pathlib import Path

import pytest

from cbtui.learning.lesson_scaffold import TEMPLATE
from lessons.judge import Judge
from lessons.lesson import BadLesson, Lesson, read_lesson
from sim.trace.timeline import Timeline
from tests.support.builder import Run


@pytest.fixture
def lesson(tmp_path: Path) -> Lesson:
    folder = tmp_path / TEMPLATE.name
    shutil.copytree(TEMPLATE, folder)
    return read_lesson(folder)


def with_checks(lesson: Lesson, source: str) -> Lesson:
    lesson.checks_path.write_text(source)
    return lesson


CHECK = """
from lessons.checks import Check, Verdict
CHECKS = (Check("it blinks", lambda run: Verdict(run.end > 0, "a blink", "none")),)
"""
ANSWER = "def blink_while_work_sleeps(run): return {}\n"


def run_of(seconds: float) -> Timeline:
    timeline = Timeline()
    run = Run()
    run.over(seconds)
    timeline.extend(run.events)
    return timeline


def test_a_run_is_judged_by_every_check(lesson: Lesson) -> None:
    judge = Judge(with_checks(lesson, CHECK + ANSWER.format(0)))
    for seconds, passed in ((0.0, False), (1.0, True)):
        (judged,) = judge.verdicts(run_of(seconds))
        assert (judged.check.asks, judged.verdict.passed) == ("it blinks", passed)


def test_the_true_answer_is_read_off_the_run(lesson: Lesson) -> None:
    judge = Judge(with_checks(lesson, CHECK + ANSWER.format("int(run.end > 0)")))
    (prediction,) = lesson.predictions
    assert [judge.true_answer(prediction, run_of(seconds)) for seconds in (0.0, 1.0)] == [0, 1]


def test_a_check_that_stumbles_over_a_run_has_not_passed(lesson: Lesson) -> None:
    source = CHECK.replace("run.end > 0", "run.calls[0]") + ANSWER.format(0)
    (judged,) = Judge(with_checks(lesson, source)).verdicts(run_of(1.0))
    assert not judged.verdict.passed
    assert judged.verdict.seen == "an error in the check: IndexError: range object index out of range"


@pytest.mark.parametrize(
    ("source", "sentence"),
    [
        ("def broken(", ":1: cannot be imported: SyntaxError: '(' was never closed"),
        ("\nimport nothing", ":2: cannot be imported: ModuleNotFoundError: No module named 'nothing'"),
        (CHECK, ": there is no function blink_while_work_sleeps, which a prediction names"),
        (ANSWER.format(0), ": the exercise needs a tuple CHECKS with at least one check"),
        ("CHECKS = [1]\n" + ANSWER.format(0), ": CHECKS is not a tuple of checks"),
        ("CHECKS = (1,)\n" + ANSWER.format(0), ": CHECKS is not a tuple of checks"),
    ],
)
def test_checks_that_cannot_be_used_are_said_to_be_so(lesson: Lesson, source: str, sentence: str) -> None:
    with pytest.raises(BadLesson) as caught:
        Judge(with_checks(lesson, source))
    assert str(caught.value) == f"{lesson.checks_path}{sentence}"


@pytest.mark.parametrize(
    ("answer", "sentence"),
    [
        ("2", ": blink_while_work_sleeps returned 2; an answer is 0 to 1"),
        ("True", ": blink_while_work_sleeps returned True; an answer is 0 to 1"),
        ("None", ": blink_while_work_sleeps returned None; an answer is 0 to 1"),
        ("{}[0]", ":4: blink_while_work_sleeps raised KeyError: 0"),
    ],
)
def test_an_answer_that_is_none_is_the_lessons_fault(lesson: Lesson, answer: str, sentence: str) -> None:
    judge = Judge(with_checks(lesson, CHECK + ANSWER.format(answer)))
    with pytest.raises(BadLesson) as caught:
        judge.true_answer(lesson.predictions[0], run_of(1.0))
    assert str(caught.value) == f"{lesson.checks_path}{sentence}"
