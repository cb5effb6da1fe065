"""The stages of a lesson's progress, as signs and in words."""

from enum import Enum

from lessons.lesson import Lesson
from lessons.progress import LessonProgress


class Stage(Enum):
    """The stages in their order, each with its sign in the menu."""

    UNTOUCHED = "·"
    OPENED = "○"
    PREDICTED = "◐"
    WATCHED = "●"
    """Only of a lesson with an exercise, which is still to be done."""
    DONE = "✓"


def stage_of(lesson: Lesson, progress: LessonProgress, *, opened: bool) -> Stage:
    """Return the stage of a lesson; one without an exercise is done once it was watched."""
    if progress.passed or (progress.seen and lesson.exercise is None):
        return Stage.DONE
    if progress.seen:
        return Stage.WATCHED
    if progress.answers:
        return Stage.PREDICTED
    return Stage.OPENED if opened else Stage.UNTOUCHED


_WORDS = {
    Stage.PREDICTED: "predicted, to be watched",
    Stage.WATCHED: "watched, exercise to do",
    Stage.DONE: "done",
}


def stage_text(stage: Stage) -> str:
    """Return a stage's sign and meaning; "" for the stages before a prediction."""
    return f"{stage.value} {_WORDS[stage]}" if stage in _WORDS else ""
