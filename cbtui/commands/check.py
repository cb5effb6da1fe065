"""``cbtui check``: a learner's file against the checks of an exercise."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from cbtui.commands.options import changes, more_lessons, values
from cbtui.commands.options.seeds import add_seed, check_seed
from cbtui.commands.options.targets import file_of, is_file_name, lesson_of, refuse
from cbtui.text.output import complain, say

if TYPE_CHECKING:
    from lessons.lesson import Lesson
    from sim.trace.events import AnyEvent


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument(
        "lesson",
        metavar="LESSON",
        help="a lesson with an exercise, or the file that cbtui start named after it",
    )
    parser.add_argument(
        "file", metavar="FILE.py", nargs="?", help="the file to check (the one that cbtui start put here)"
    )
    add_limit(parser, 60)
    add_seed(parser)
    changes.add_on(parser)
    more_lessons.add_option(parser)


def add_limit(parser: argparse.ArgumentParser, usual: float) -> None:
    """Add ``--limit``, the limit of a run in real seconds."""
    parser.add_argument(
        "--limit",
        metavar="SECONDS",
        type=values.duration,
        default=usual,
        help="real time that a run may take; on the real clock, beyond its own length (%(default)g)",
    )


def check(options: argparse.Namespace) -> int:
    """Check a file; returns the exit code: 0 it passes every check, 1 it does not."""
    if is_file_name(options.lesson) and options.file is None:
        options.file, options.lesson = options.lesson, _lesson_named_by(options.lesson)
    lesson = exercise_of(options.lesson)
    real = changes.real_ros_of(options)
    check_seed(options.seed, lesson.setup.clock)
    file = _file(lesson, options.file)
    from cbtui.runs.judged.check_text import checked_text
    from cbtui.runs.judged.checking import check as run_and_judge
    from cbtui.runs.judged.schedule_text import unplayed_text
    from cbtui.terminal.progress_line import ProgressLine
    from lessons.judge import Judge
    from sim.quantities.nanoseconds import SECOND

    with ProgressLine() as line:

        def tell(batch: "list[AnyEvent]") -> None:
            at = max((event.t for event in batch), default=0)
            line.show(f"{file.name} runs: {at / SECOND:.1f} s of {lesson.run.seconds:g} s")

        tell([])
        checked = run_and_judge(
            lesson, Judge(lesson), file, options.limit, seed=options.seed, real=real, take=tell
        )
    say(checked_text(checked))
    for trouble in (checked.run.trouble, unplayed_text(options.seed, checked.run.timeline.choices)):
        if trouble:
            complain(trouble)
    if checked.good:
        _note(lesson)
    return 0 if checked.good else 1


def exercise_of(name: str) -> "Lesson":
    """Return the lesson with that id; exits with code 2 and one line if it has no exercise."""
    lesson = lesson_of(name)
    if lesson.exercise is None:
        refuse(f"the lesson {name} has no exercise; cbtui list shows which lessons have one")
    return lesson


def _lesson_named_by(file: str) -> str:
    """Return the id of the lesson after which a learner's file is named."""
    from lessons.catalogue import lessons

    of_lessons = {each.file_name: each.id for each in lessons() if each.exercise is not None}
    lesson = of_lessons.get(file_of(file).name)
    return lesson or refuse(
        f"{file} is not named after a lesson; name that before it: cbtui check LESSON {file}; "
        f"what goes wrong in a node of your own is told by cbtui run {file}"
    )


def _file(lesson: "Lesson", name: str | None) -> Path:
    if name is not None:
        return file_of(name)
    path = Path(lesson.file_name)
    if not path.is_file():
        refuse(f"there is no {path} here; name your file, or begin one with cbtui start {lesson.id}")
    return path


def _note(lesson: "Lesson") -> None:
    from lessons.progress import Progress

    progress = Progress()
    progress.passes(lesson.id)
    for trouble in progress.troubles():
        complain(trouble)
