"""A lesson's page as text: what of it can be read already, given how far the learner has come."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import TypeAlias

from cbtui.learning.outcome import PredictionOutcome, run_text
from lessons.description import Exercise, Prediction
from lessons.lesson import Lesson
from lessons.progress import LessonProgress


class PageSection(StrEnum):
    """The parts of a page, from its top to its bottom."""

    ABOUT = "about"
    TASK = "task"
    PREDICTION = "prediction"
    GUIDE = "guide"
    SHOWN = "shown"
    EXPLANATION = "explanation"
    EXERCISE = "exercise"
    HINTS = "hints"
    NEXT = "next"


Page: TypeAlias = Mapping[str, str]
"""The Markdown of the parts that can be read now."""


@dataclass(frozen=True)
class PageKeys:
    """The keys that the page names, as people write them."""

    predict: str
    explain: str
    hint: str
    solution: str
    exercise: str


@dataclass(frozen=True)
class PageState:
    """How far a learner is in a lesson.

    ``outcome`` is what the lesson's run showed, None as long as that is not known; ``held`` tells that a run
    is going on to find out.
    """

    progress: LessonProgress
    outcome: PredictionOutcome | None = None
    held: bool = False


def all_predicted(lesson: Lesson, progress: LessonProgress) -> bool:
    """Tell whether every prediction was answered."""
    return len(progress.answers) >= len(lesson.predictions)


def introduction(guide: str) -> str:
    """Return the beginning of a guide, which describes the scene and gives no answers away."""
    return _HEADING.split(guide, maxsplit=1)[0]


def short_description(lesson: Lesson, progress: LessonProgress) -> str:
    """Return what a lesson teaches; as long as that would answer a question, how its guide begins."""
    if progress.seen or not lesson.predictions:
        return lesson.teaches
    _title, paragraph, *_ = lesson.guide.split("\n\n")
    plain = " ".join(re.sub("[`*]", "", paragraph).split())
    return " ".join(_SENTENCE.split(plain)[:2])


def page_of(lesson: Lesson, standing: PageState, signs: PageKeys) -> Page:
    """Return a lesson's page; what a prediction asks for is not on it before the learner has answered."""
    parts = dict(_parts(lesson, standing, signs))
    return {part: parts[part] for part in PageSection if parts.get(part)}


def page_of_exercise(lesson: Lesson, standing: PageState, signs: PageKeys, task: str) -> Page:
    """Return the page beside the exercise: the task, the hints, and what was explained already."""
    assert lesson.exercise is not None, "it is on screen"
    told = page_of(lesson, standing, signs) if standing.progress.seen else {}
    return {
        PageSection.EXERCISE: task,
        PageSection.HINTS: _hints(lesson.exercise, standing.progress, signs),
        **{part: told[part] for part in (PageSection.EXPLANATION, PageSection.GUIDE) if part in told},
    }


_HEADING = re.compile(r"^(?=## )", re.MULTILINE)
_SENTENCE = re.compile(r"(?<=[.?!]) ")
_WHY = "## Why"


def _parts(lesson: Lesson, standing: PageState, signs: PageKeys) -> Iterator[tuple[PageSection, str]]:
    progress = standing.progress
    about, *sections = _HEADING.split(lesson.guide)
    why = "".join(section for section in sections if section.startswith(_WHY))
    seen = progress.seen
    yield PageSection.ABOUT, about
    if lesson.task is not None:
        yield PageSection.TASK, f"## Task\n\n{lesson.task}"
    if lesson.predictions and not seen:
        yield PageSection.PREDICTION, _predictions(lesson, progress, signs)
    if seen or all_predicted(lesson, progress):
        yield PageSection.GUIDE, "".join(section for section in sections if not section.startswith(_WHY))
    if not seen:
        return
    if lesson.predictions:
        yield PageSection.SHOWN, _shown(lesson, standing, signs)
    yield PageSection.EXPLANATION, "\n".join((re.sub(r"^# ", "## ", lesson.explanation), why))
    if lesson.exercise is not None:
        yield PageSection.EXERCISE, _exercise(lesson.exercise, progress, signs)
        yield PageSection.HINTS, _hints(lesson.exercise, progress, signs)
    if lesson.following:
        yield PageSection.NEXT, f"**Next:** {lesson.following}"


def _predictions(lesson: Lesson, progress: LessonProgress, signs: PageKeys) -> str:
    """What was predicted, without a word on whether it is true."""
    given = [
        f"{each.question}\n\n> {each.answers[answer]}"
        for each, answer in zip(lesson.predictions, progress.answers, strict=False)
    ]
    if all_predicted(lesson, progress):
        way_on = f"The run decides. When you have seen enough, `{signs.explain}` tells what is true, and why."
    else:
        way_on = (
            f"`{signs.predict}` asks what you expect; what to watch for opens here then. "
            f"`{signs.explain}` tells what is true, and why."
        )
    title = "## Your prediction" if given else "## Not predicted yet"
    return "\n\n".join((title, *given, way_on))


def _shown(lesson: Lesson, standing: PageState, signs: PageKeys) -> str:
    outcome, answers = standing.outcome, standing.progress.answers
    if outcome is None:
        note = (
            "The lesson is run once more, to read off what is true …"
            if standing.held
            else f"`{signs.explain}` holds your prediction against a run."
        )
        return f"## What the run showed\n\n{note}"
    if outcome.trouble is not None:
        trouble = f"Your prediction could not be held against a run: {outcome.trouble}."
        return f"## What the run showed\n\n{trouble}"
    told = [
        _verdict(prediction, answers[place] if place < len(answers) else None, true)
        for place, (prediction, true) in enumerate(zip(lesson.predictions, outcome.true, strict=True))
    ]
    held = f"Read off {run_text(lesson)}."
    return "\n\n".join((f"## What the run showed: {tally(lesson, standing)}", *told, held))


def tally(lesson: Lesson, standing: PageState) -> str:
    """Say how many predictions came true."""
    answers, true = standing.progress.answers, standing.outcome.true if standing.outcome else ()
    if not answers:
        return "not predicted"
    right = sum(answer == shown for answer, shown in zip(answers, true, strict=False))
    return f"{right} of {len(lesson.predictions)} as you said"


def _verdict(prediction: Prediction, answer: int | None, true: int) -> str:
    shown = prediction.answers[true]
    if answer == true:
        told = f"✓ As you said: **{shown}**"
    elif answer is None:
        told = f"· Not predicted. True is: **{shown}**"
    else:
        told = f"✗ You said: {prediction.answers[answer]}\n\n→ True is: **{shown}**"
    because = prediction.because
    if true != prediction.right:
        expected = prediction.answers[prediction.right]
        because = f"The lesson expected “{expected}”; the run shows otherwise, and the run counts."
    return f"{prediction.question}\n\n{told}\n\n{because}"


def _exercise(exercise: Exercise, progress: LessonProgress, signs: PageKeys) -> str:
    title = "## Exercise: passed ✓" if progress.passed else "## Exercise"
    begin = f"`{signs.exercise}` goes there: to a file of your own in the current folder."
    return "\n\n".join((title, exercise.asks.strip(), begin))


def _hints(exercise: Exercise, progress: LessonProgress, signs: PageKeys) -> str:
    taken = exercise.hints[: progress.hints]
    total = len(exercise.hints)
    told = [f"**Hint {number} of {total}:** {hint}" for number, hint in enumerate(taken, start=1)]
    if len(taken) < total:
        told.append(
            f"`{signs.hint}` gives hint {len(taken) + 1} of {total}; `{signs.solution}` the solution."
        )
    else:
        told.append(f"`{signs.solution}` shows the solution.")
    return "\n\n".join(told)
