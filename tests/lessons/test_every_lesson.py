"""Every lesson is as it says: answers, diagnoses, starter and solution are held against real runs."""

import ast
import re
import sys
from pathlib import Path

import pytest

from cbtui.learning.lesson_lint import faults_of
from cbtui.learning.lesson_scaffold import TEMPLATE
from cbtui.runs.setup.lesson_setup import setup_to_judge
from cbtui.runs.setup.shown_program import of_exercise
from lessons.catalogue import find, lessons
from lessons.checks import rotations
from lessons.judge import Judge
from lessons.lesson import Lesson, read_lesson
from sim.quantities.nanoseconds import SECOND
from sim.trace.timeline import Timeline
from tests.support.daily import first_daily
from tests.support.engine_runs import run_lesson, run_to_end

every_lesson = pytest.mark.parametrize("lesson", lessons(), ids=lambda lesson: lesson.id)
EXERCISES = [lesson for lesson in (read_lesson(TEMPLATE), *lessons()) if lesson.exercise is not None]


@pytest.mark.parametrize(
    "folder", first_daily(TEMPLATE, *(lesson.folder for lesson in lessons())), ids=lambda path: path.name
)
def test_a_lesson_is_as_it_says(folder: Path) -> None:
    assert list(faults_of(folder)) == []


@every_lesson
def test_a_lesson_asks_gives_a_task_and_explains(lesson: Lesson) -> None:
    assert 1 <= len(lesson.predictions) <= 2
    assert lesson.task, "lesson.toml needs a task"
    lines = len(lesson.explanation.splitlines())
    assert 8 <= lines <= 30, f"explain.md has {lines} lines, and 8 to 30 fill its pane"


@every_lesson
def test_the_lesson_before_announces_it(lesson: Lesson) -> None:
    assert lesson.number == 1 or lesson.teaser, "lesson.toml needs a teaser"


@every_lesson
def test_a_lesson_has_a_robot_that_moves_or_a_scene(lesson: Lesson) -> None:
    assert lesson.scene or lesson.unit.startswith("5"), "lesson.toml needs a [[scene]]: no robot moves"


@pytest.mark.parametrize("lesson", [each for each in EXERCISES if each.scene], ids=lambda lesson: lesson.id)
def test_callbacks_that_only_the_exercise_has_have_figures(lesson: Lesson) -> None:
    assert lesson.starter_path is not None
    added = _methods(lesson.starter_path) - _methods(lesson.node_path)
    shown = of_exercise(lesson, [lesson], lesson.starter_path).scene
    assert added <= {each.follows for each in shown}, "lesson.toml needs [[exercise.scene]]"


def _methods(file: Path) -> set[str]:
    return set(re.findall(r"^    def (\w+)\(self", file.read_text(encoding="utf-8"), re.MULTILINE))


@every_lesson
def test_what_is_asked_before_the_run_is_short(lesson: Lesson) -> None:
    for prediction in lesson.predictions:
        assert prediction.question.endswith("?")
        assert len(prediction.question) <= 160
        assert all(len(answer) <= 80 and not answer.endswith(".") for answer in prediction.answers)
        assert prediction.because.endswith(".")
        assert len(prediction.because) <= 200


@every_lesson
def test_the_checks_of_a_lesson_read_traces_and_diagnoses_and_nothing_else(lesson: Lesson) -> None:
    tree = ast.parse(lesson.checks_path.read_text(encoding="utf-8"))
    imported = {node.module or "" for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    imported |= {name.name for node in ast.walk(tree) if isinstance(node, ast.Import) for name in node.names}
    allowed = re.compile(r"lessons\.checks|sim\.(trace|diagnosis)(\..+)?")
    assert all(allowed.fullmatch(name) or name.split(".")[0] in sys.stdlib_module_names for name in imported)


@pytest.mark.parametrize("lesson", EXERCISES, ids=lambda lesson: lesson.id)
def test_the_files_of_an_exercise_fit_an_80_column_pane(lesson: Lesson) -> None:
    for path in (lesson.starter_path, lesson.solution_path):
        assert path is not None
        assert all(len(line) <= 79 for line in path.read_text(encoding="utf-8").splitlines())


@pytest.mark.parametrize(("threads", "drives_on"), [(1, True), (4, False)])
def test_with_one_shared_group_the_robot_drives_on_with_one_thread_alone(
    threads: int, drives_on: bool
) -> None:
    run = Timeline()
    run.extend(run_lesson("shared-group", 40.0, threads=threads).events)
    assert (rotations(run)[-1].end < run.end) == drives_on
    assert "With four threads the robot **never drives on**." in find("shared-group").explanation


def test_what_got_stuck_is_shown_when_the_last_of_its_waits_begins() -> None:
    lesson = find("call-in-a-callback")
    nothing_stuck = Judge(lesson).verdicts(run_lesson(lesson.id, 5.0).timeline)[0].verdict
    assert nothing_stuck.at is not None
    assert 1.3 <= nothing_stuck.at / SECOND < 1.31, "the gripper replies 0.3 s after the call"


def test_a_loaf_that_is_still_in_the_oven_is_not_counted_as_baked() -> None:
    lesson = find("clock-set-back")
    assert lesson.solution_path is not None
    run = run_to_end(setup_to_judge(lesson, lesson.solution_path)).timeline
    out, in_time = (each.verdict.seen.split()[0] for each in Judge(lesson).verdicts(run)[:2])
    assert out == in_time


def test_a_belt_that_moves_before_the_service_begins_has_not_moved_on_after_the_call() -> None:
    lesson = find("service-in-a-service")
    run = run_lesson(lesson.id, 6.0, 2.0).timeline  # the belt is due then, and timers come first
    stands = lesson.predictions[1]
    assert Judge(lesson).true_answer(stands, run) == stands.right


def test_a_lamp_that_stands_still_for_three_seconds_does_not_blink_all_the_time(tmp_path: Path) -> None:
    lesson = find("spin-inside-a-callback")
    assert lesson.solution_path is not None
    text = lesson.solution_path.read_text(encoding="utf-8")
    for cured, still in (
        ("SEARCH_TIME = 1.0", "STILL = [3.0]\nSEARCH_TIME = 1.0"),
        ("self.blink_callback, callback_group=self.group", "self.blink_callback"),
        ('info("BLINK")', 'info("BLINK")\n        time.sleep(STILL.pop() if STILL else 0)'),
    ):
        assert cured in text
        text = text.replace(cured, still)
    path = tmp_path / "node.py"
    path.write_text(text, encoding="utf-8")
    judged = Judge(lesson).verdicts(run_to_end(setup_to_judge(lesson, path)).timeline)
    failed = [each.check.asks for each in judged if not each.verdict.passed]
    assert "blink_callback never waits too long" in failed
