"""A lesson's page as Markdown: the sections that are unlocked at the learner's progress."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import TypeAlias

from cbtui.learning.outcome import PredictionOutcome, run_text
from cbtui.learning.stage import all_predicted, is_revealed
from lessons.description import Exercise, Prediction
from lessons.lesson import Lesson
from lessons.progress import LessonProgress


class PageSection(StrEnum):
    """The sections of a page in their order."""

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
"""The Markdown of the unlocked sections."""


@dataclass(frozen=True)
class PageKeys:
    """The keys that the page names, in display form."""

    predict: str
    explain: str
    hint: str
    solution: str
    exercise: str
    call_service: str


@dataclass(frozen=True)
class PageState:
    """The state that a page depends on.

    ``outcome`` is the result of the lesson's run, None while unknown; ``is_running`` tells that the run is
    in progress. ``was_called`` tells whether the run on screen has the call that the explanation is about.
    """

    progress: LessonProgress
    outcome: PredictionOutcome | None = None
    is_running: bool = False
    was_called: bool = True


def introduction(guide: str) -> str:
    """Return the first section of a guide, which contains no answers."""
    return _HEADING.split(guide, maxsplit=1)[0]


def short_description(lesson: Lesson, progress: LessonProgress) -> str:
    """Return what a lesson teaches, or, while that would give away an answer, the start of its guide."""
    if progress.seen or not lesson.predictions:
        return lesson.teaches
    _title, paragraph, *_ = lesson.guide.split("\n\n")
    plain = " ".join(re.sub("[`*]", "", paragraph).split())
    return " ".join(_SENTENCE.split(plain)[:2])


def page_of(lesson: Lesson, state: PageState, signs: PageKeys) -> Page:
    """Return a lesson's page; answers to predictions stay locked until the learner has answered."""
    parts = dict(_parts(lesson, state, signs))
    return {part: parts[part] for part in PageSection if parts.get(part)}


def page_of_exercise(lesson: Lesson, state: PageState, signs: PageKeys, task: str) -> Page:
    """Return the page of the exercise screen: the task, the hints, and unlocked explanations."""
    assert lesson.exercise is not None, "it is on screen"
    page = page_of(lesson, state, signs) if state.progress.seen else {}
    return {
        PageSection.EXERCISE: task,
        PageSection.HINTS: _hints(lesson.exercise, state.progress, signs),
        **{part: page[part] for part in (PageSection.EXPLANATION, PageSection.GUIDE) if part in page},
    }


_HEADING = re.compile(r"^(?=## )", re.MULTILINE)
_SENTENCE = re.compile(r"(?<=[.?!]) ")
_WHY = "## Why"


def _parts(lesson: Lesson, state: PageState, signs: PageKeys) -> Iterator[tuple[PageSection, str]]:
    progress = state.progress
    about, *sections = _HEADING.split(lesson.guide)
    why = "".join(section for section in sections if section.startswith(_WHY))
    seen = progress.seen
    yield PageSection.ABOUT, about
    if lesson.task is not None:
        yield PageSection.TASK, f"## Task\n\n{lesson.task}"
    if lesson.predictions and not seen:
        yield PageSection.PREDICTION, _predictions(lesson, progress, signs)
    if is_revealed(lesson, progress):
        yield PageSection.GUIDE, "".join(section for section in sections if not section.startswith(_WHY))
    if not seen:
        return
    if lesson.predictions:
        yield PageSection.SHOWN, _shown(lesson, state, signs)
    title, told = re.sub(r"^# ", "## ", lesson.explanation).split("\n", 1)
    if not state.was_called:
        note = f"Not yet: nobody has called `{lesson.service.name}` in this run. `{signs.call_service}` does."
        title = f"{title}\n\n**{note}**"
    yield PageSection.EXPLANATION, "\n".join((title, told, why))
    if lesson.exercise is not None:
        yield PageSection.EXERCISE, _exercise(lesson.exercise, progress, signs)
        yield PageSection.HINTS, _hints(lesson.exercise, progress, signs)
    if lesson.following:
        yield PageSection.NEXT, f"**Next:** {lesson.following}"


def _predictions(lesson: Lesson, progress: LessonProgress, signs: PageKeys) -> str:
    """The given predictions without their results."""
    given = [
        f"{each.question}\n\n> {each.answers[answer]}"
        for each, answer in zip(lesson.predictions, progress.answers, strict=False)
    ]
    if all_predicted(lesson, progress):
        how_to_continue = (
            f"Now watch the run. When you have seen enough, `{signs.explain}` tells what happened, and why."
        )
    else:
        how_to_continue = (
            f"`{signs.predict}` asks what you expect, and then shows here what to watch for. "
            f"`{signs.explain}` tells what happens, and why."
        )
    title = "## Your prediction" if given else "## No prediction yet"
    return "\n\n".join((title, *given, how_to_continue))


def _shown(lesson: Lesson, state: PageState, signs: PageKeys) -> str:
    outcome, answers = state.outcome, state.progress.answers
    if outcome is None:
        note = (
            "The lesson runs once more to check your prediction …"
            if state.is_running
            else f"`{signs.explain}` checks your prediction against a run."
        )
        return f"## What the run showed\n\n{note}"
    if outcome.trouble is not None:
        trouble = f"Your prediction could not be checked against a run: {outcome.trouble}."
        return f"## What the run showed\n\n{trouble}"
    results = [
        _verdict(prediction, answers[place] if place < len(answers) else None, true)
        for place, (prediction, true) in enumerate(zip(lesson.predictions, outcome.true, strict=True))
    ]
    held = f"Checked against {run_text(lesson)}{' on real ROS 2' if outcome.is_real else ''}."
    return "\n\n".join((f"## What the run showed: {tally(lesson, state)}", *results, held))


def tally(lesson: Lesson, state: PageState) -> str:
    """Return the number of right predictions, in words."""
    answers, true = state.progress.answers, state.outcome.true if state.outcome else ()
    if not answers:
        return "no prediction"
    right = sum(answer == shown for answer, shown in zip(answers, true, strict=False))
    return f"You got {right} of {len(lesson.predictions)}"


def _verdict(prediction: Prediction, answer: int | None, true: int) -> str:
    shown = prediction.answers[true]
    if answer == true:
        result = f"✓ You were right: **{shown}**"
    elif answer is None:
        result = f"· You made no prediction. What happened: **{shown}**"
    else:
        result = f"✗ You said: {prediction.answers[answer]}\n\n→ What happened: **{shown}**"
    because = prediction.because
    if true != prediction.right:
        expected = prediction.answers[prediction.right]
        because = f"The lesson expected “{expected}”; the run shows something else, and the run counts."
    return f"{prediction.question}\n\n{result}\n\n{because}"


def _exercise(exercise: Exercise, progress: LessonProgress, signs: PageKeys) -> str:
    title = "## Exercise: passed ✓" if progress.passed else "## Exercise"
    begin = f"`{signs.exercise}` starts it, in a file of your own in the current folder."
    return "\n\n".join((title, exercise.asks.strip(), begin))


def _hints(exercise: Exercise, progress: LessonProgress, signs: PageKeys) -> str:
    taken = exercise.hints[: progress.hints]
    total = len(exercise.hints)
    parts = [f"**Hint {number} of {total}:** {hint}" for number, hint in enumerate(taken, start=1)]
    if len(taken) < total:
        parts.append(
            f"`{signs.hint}` gives hint {len(taken) + 1} of {total}; `{signs.solution}` shows the solution."
        )
    else:
        parts.append(f"`{signs.solution}` shows the solution.")
    return "\n\n".join(parts)
