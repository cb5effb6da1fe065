"""What can be read on a lesson's page at each stage, for every lesson there is."""

import msgspec
import pytest

from cbtui.learning.lesson_page import (
    PageKeys,
    PageSection,
    PageState,
    introduction,
    page_of,
    page_of_exercise,
    tally,
)
from cbtui.learning.outcome import PredictionOutcome, run_text
from cbtui.learning.stage import Stage, stage_of, steps_of
from lessons.catalogue import find, lessons
from lessons.lesson import Lesson
from lessons.progress import LessonProgress

SIGNS = PageKeys("P", "a", "h", "H", "e", "s")
EVERY = pytest.mark.parametrize("lesson", lessons(), ids=lambda lesson: lesson.id)


def known(lesson: Lesson, answers: tuple[int, ...] = (), *, seen: bool = False) -> LessonProgress:
    return LessonProgress(lesson=lesson.id, answers=answers, seen=seen)


def rightly(lesson: Lesson) -> tuple[int, ...]:
    return tuple(each.right for each in lesson.predictions)


@EVERY
def test_a_page_says_why_only_after_the_run(lesson: Lesson) -> None:
    for answers in ((), rightly(lesson)[:1], rightly(lesson)):
        page = page_of(lesson, PageState(known(lesson, answers)), SIGNS)
        assert not page.keys() & {
            PageSection.SHOWN,
            PageSection.EXPLANATION,
            PageSection.EXERCISE,
            PageSection.HINTS,
            PageSection.NEXT,
        }
        text = "\n".join(page.values())
        assert not any(prediction.because in text for prediction in lesson.predictions)
        assert (PageSection.GUIDE in page) == (len(answers) == len(lesson.predictions))


@EVERY
def test_a_page_leaves_out_nothing_of_a_lesson_that_was_watched(lesson: Lesson) -> None:
    outcome = PredictionOutcome(rightly(lesson))
    page = page_of(lesson, PageState(known(lesson, rightly(lesson), seen=True), outcome), SIGNS)
    text = "\n".join(page.values())
    lines = f"{lesson.guide}\n{lesson.explanation}".splitlines()
    told = {line.lstrip("# ") for line in text.splitlines()}
    assert [line for line in lines if line and line.lstrip("# ") not in told] == []
    assert all(prediction.because in text for prediction in lesson.predictions)
    assert list(page) == [part for part in PageSection if part in page]


@EVERY
def test_what_is_read_before_the_question_has_no_section(lesson: Lesson) -> None:
    assert introduction(lesson.guide).startswith("# ")
    assert "\n## " not in introduction(lesson.guide)


def test_answers_are_counted_that_came_true() -> None:
    lesson = find("shared-group")
    for answers, told in (((0, 1), "2 of 2"), ((0, 0), "1 of 2"), ((1,), "0 of 2")):
        assert told in tally(lesson, PageState(known(lesson, answers, seen=True), PredictionOutcome((0, 1))))


def test_an_exercise_has_its_task_first_and_no_explanation_that_was_not_seen() -> None:
    lesson = find("split-groups")
    page = page_of_exercise(lesson, PageState(known(lesson)), SIGNS, "mend it")
    assert list(page) == [PageSection.EXERCISE, PageSection.HINTS]
    assert page[PageSection.EXERCISE] == "mend it"
    seen = page_of_exercise(lesson, PageState(known(lesson, seen=True)), SIGNS, "mend it")
    assert PageSection.EXPLANATION in seen


@pytest.mark.parametrize(
    ("lesson", "words"),
    [
        ("shared-group", "a run of 30 s"),
        ("how-many-threads", "a run of 30 s with 4 threads"),
        (
            "reentrant-2-threads",
            "a run of 28 s with /dummy_server_srv called at 2.55, 10.55, 10.6 and 10.65 s",
        ),
        ("qos-never-matches", "a run of 20 s with `ros2 topic info -v /temperature` given at 10 s"),
    ],
)
def test_a_page_says_which_run_decides(lesson: str, words: str) -> None:
    assert run_text(find(lesson)) == words


def test_a_lesson_is_done_once_it_is_predicted_explained_and_solved() -> None:
    plain, exercised = find("shared-group"), find("split-groups")
    replace = msgspec.structs.replace
    watched, explained = (
        known(plain, (0, 0), seen=True),
        replace(known(plain, (0, 0), seen=True), explained=True),
    )
    assert stage_of(plain, watched, opened=True) is Stage.WATCHED
    assert stage_of(plain, explained, opened=True) is Stage.DONE
    assert stage_of(plain, replace(explained, answers=()), opened=True) is Stage.WATCHED
    explained = replace(known(exercised, (0, 0), seen=True), explained=True)
    assert stage_of(exercised, explained, opened=True) is Stage.WATCHED
    assert stage_of(exercised, replace(explained, passed=True), opened=True) is Stage.DONE
    assert stage_of(plain, known(plain), opened=True) is Stage.OPENED
    assert stage_of(plain, known(plain), opened=False) is Stage.UNTOUCHED


def test_the_first_step_that_is_not_done_is_current() -> None:
    lesson, replace = find("split-groups"), msgspec.structs.replace

    def told(progress: LessonProgress, checks: str = "") -> str:
        return " ▸ ".join(step.text for step in steps_of(lesson, progress, checks))

    assert told(known(lesson)) == "Predict ● ▸ Run ▸ Explain ▸ Exercise"
    watched = known(lesson, (0, 0), seen=True)
    assert told(replace(watched, seen=False)) == "Predict ✓ ▸ Run ● ▸ Explain ▸ Exercise"
    assert told(watched) == "Predict ✓ ▸ Run ✓ ▸ Explain ● ▸ Exercise"
    assert told(known(lesson, seen=True)) == "Predict missed ▸ Run ✓ ▸ Explain ● ▸ Exercise"
    assert told(replace(watched, explained=True), "2/5") == "Predict ✓ ▸ Run ✓ ▸ Explain ✓ ▸ Exercise 2/5"
    assert [step.name for step in steps_of(find("shared-group"), watched)] == ["Predict", "Run", "Explain"]
