"""How far a learner is in a lesson, as a sign and in words."""

from enum import Enum

from lessons.lesson import Lesson
from lessons.progress import LessonProgress


class Stage(Enum):
    """The stages from nothing to all, each with its sign in the menu."""

    UNTOUCHED = "·"
    OPENED = "○"
    PREDICTED = "◐"
    WATCHED = "●"
    """Only of a lesson with an exercise: that is to be done yet."""
    DONE = "✓"


def stage_of(lesson: Lesson, progress: LessonProgress, *, opened: bool) -> Stage:
    """Return how far a learner is in a lesson; one without an exercise is done when it was watched."""
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
    """Return a sign with what it stands for; "" for what being opened or not says already."""
    return f"{stage.value} {_WORDS[stage]}" if stage in _WORDS else ""
