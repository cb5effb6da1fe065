"""The stages of a lesson's progress, as signs and in words, and the steps through a lesson."""

from collections.abc import Iterable, Iterator, Mapping
from enum import Enum
from typing import NamedTuple

from lessons.lesson import Lesson
from lessons.progress import LessonProgress


def all_predicted(lesson: Lesson, progress: LessonProgress) -> bool:
    """Tell whether every prediction was answered."""
    return len(progress.answers) >= len(lesson.predictions)


def is_revealed(lesson: Lesson, progress: LessonProgress) -> bool:
    """Tell whether a run can be shown because it no longer gives away an answer to a prediction."""
    return progress.seen or all_predicted(lesson, progress)


class Stage(Enum):
    """The stages in their order, each with its sign in the menu."""

    UNTOUCHED = "·"
    OPENED = "○"
    PREDICTED = "◐"
    WATCHED = "●"
    """Watched, with something left to do."""
    DONE = "✓"


def stage_of(lesson: Lesson, progress: LessonProgress, *, opened: bool) -> Stage:
    """Return the stage of a lesson; a done lesson is predicted, explained and, with an exercise, solved."""
    solved = progress.passed or lesson.exercise is None
    if progress.explained and all_predicted(lesson, progress) and solved:
        return Stage.DONE
    if progress.seen or progress.passed:
        return Stage.WATCHED
    if progress.answers:
        return Stage.PREDICTED
    return Stage.OPENED if opened else Stage.UNTOUCHED


def stage_of_puzzle(progress: LessonProgress) -> Stage:
    """Return the stage of a puzzle; viewing its solution alone does not make it done."""
    return Stage.DONE if progress.passed else Stage.WATCHED if progress.solution else Stage.UNTOUCHED


class StageNote(NamedTuple):
    """The sign of a stage and what it means, or what is left to do; both empty if there is nothing to say."""

    sign: str = ""
    words: str = ""

    @property
    def text(self) -> str:
        """Sign and words, with a blank between them."""
        return f"{self.sign} {self.words}".strip()


def puzzle_note(progress: LessonProgress) -> StageNote:
    """Return the note on a puzzle; an empty one if it is untouched."""
    stage = stage_of_puzzle(progress)
    words = {Stage.DONE: "solved", Stage.WATCHED: "solution seen, not solved yet"}
    return StageNote(stage.value, words[stage]) if stage in words else StageNote()


_MEANINGS = {
    Stage.UNTOUCHED: "not opened yet",
    Stage.OPENED: "opened",
    Stage.PREDICTED: "predicted, not watched yet",
    Stage.WATCHED: "watched; prediction, explanation or exercise is missing",
    Stage.DONE: "done: predicted, explained, and the exercise passed",
}


def meaning_of(stage: Stage) -> str:
    """Return the meaning of a stage's sign."""
    return _MEANINGS[stage]


def stage_note(lesson: Lesson, progress: LessonProgress, stage: Stage) -> StageNote:
    """Return the note on a lesson; an empty one for the stages before a prediction."""
    match stage:
        case Stage.PREDICTED:
            text = f"predicted, not watched yet: {_to_watch(lesson)}"
        case Stage.WATCHED if not progress.seen:
            text = f"exercise passed, not watched yet: {_to_watch(lesson)}"
        case Stage.WATCHED if not progress.explained:
            text = "watched, not explained yet"
        case Stage.WATCHED if lesson.exercise is not None and not progress.passed:
            text = "explained, exercise to do"
        case Stage.WATCHED:
            text = "explained without a prediction"
        case Stage.DONE:
            text = "done"
        case _:
            return StageNote()
    return StageNote(stage.value, text)


def _to_watch(lesson: Lesson) -> str:
    """What makes a lesson one that was watched."""
    called = f" with a call of {lesson.service.name}," if lesson.run.calls else ""
    return f"run it for {lesson.run.seconds:g} s{called} or to its end, or have it explained"


def next_lesson(lessons: Iterable[Lesson], stages: Mapping[str, Stage]) -> Lesson | None:
    """Return the first lesson that was begun and not watched, or else not begun; None if there is none."""
    left = (lesson for lesson in lessons if stages[lesson.id] not in (Stage.WATCHED, Stage.DONE))
    return min(left, key=lambda lesson: stages[lesson.id] is not Stage.PREDICTED, default=None)


class StepState(Enum):
    """The learner's progress with a step."""

    DONE = "✓"
    CURRENT = "●"
    OPEN = ""


class LessonStep(NamedTuple):
    """One of the steps through a lesson; ``note`` is shown in place of the state's sign."""

    name: str
    state: StepState
    note: str = ""

    @property
    def text(self) -> str:
        """The name with its note or sign."""
        return f"{self.name} {self.note or self.state.value}".rstrip()


def steps_of(lesson: Lesson, progress: LessonProgress, checks: str = "") -> tuple[LessonStep, ...]:
    """Return the steps that a lesson has; the first one that is not done is current.

    ``checks`` tells how many checks of the exercise pass, if it is on screen: the exercise is current then.
    """
    done, predicted = dict(_steps_done(lesson, progress)), all_predicted(lesson, progress)
    current = "Exercise" if checks else next((name for name, is_done in done.items() if not is_done), "")
    return tuple(
        LessonStep(
            name,
            StepState.CURRENT if name == current else StepState.DONE if is_done else StepState.OPEN,
            checks
            if name == "Exercise"
            else "missed"
            if name == "Predict" and not predicted and is_done
            else "",
        )
        for name, is_done in done.items()
    )


def _steps_done(lesson: Lesson, progress: LessonProgress) -> Iterator[tuple[str, bool]]:
    """Yield each step, and whether it is done; after the run a missing prediction counts as done."""
    if lesson.predictions:
        yield "Predict", progress.seen or all_predicted(lesson, progress)
    yield "Run", progress.seen
    yield "Explain", progress.explained
    if lesson.exercise is not None:
        yield "Exercise", progress.passed
