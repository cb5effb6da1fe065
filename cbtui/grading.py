"""The files of many learners, each checked against its exercise, and the table of what came of it."""

import csv
import io
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from cbtui.check_text import verdict_line
from cbtui.checking import Checked, check
from cbtui.commands.targets import is_text
from lessons.judge import Judge
from lessons.lesson import Lesson

_PYTHON = ".py"


@dataclass(frozen=True)
class Paper:
    """What one learner handed in for one exercise; without a lesson or a file, why it cannot be checked."""

    learner: str
    lesson: Lesson | None = None
    file: Path | None = None
    problem: str = ""


@dataclass(frozen=True)
class Grade:
    """What came of a paper; ``checked`` is None where it could not be run."""

    paper: Paper
    checked: Checked | None = None

    @property
    def passed(self) -> int:
        """How many checks passed."""
        return 0 if self.checked is None else self.checked.passed

    @property
    def total(self) -> int:
        """How many checks there are."""
        return 0 if self.checked is None else self.checked.total

    @property
    def good(self) -> bool:
        """Whether every check passed."""
        return self.checked is not None and self.checked.good

    @property
    def problem(self) -> str:
        """What kept the paper from being judged; empty where it was."""
        if self.checked is None:
            return self.paper.problem
        return self.checked.run.trouble or ""


def papers_in(folder: Path, exercises: Sequence[Lesson], only: Lesson | None) -> list[Paper]:
    """Return what lies in a folder: a folder or a file for each learner, in order of their names.

    A file is told by its name: ``split_groups.py`` in a learner's folder, ``split_groups_ann.py`` or
    ``ann_split_groups.py`` beside others'. With ``only`` all is for that exercise, and a learner's only
    Python file may be called anything.

    Raises:
        OSError: the folder cannot be read.
    """
    papers: list[Paper] = []
    for path in sorted(folder.iterdir()):
        if path.name.startswith((".", "__")):
            continue
        if path.is_dir():
            papers += _of_learner(path, exercises, only)
        elif path.suffix == _PYTHON:
            papers.append(_of_file(path, exercises, only))
    return papers


def grades(papers: Iterable[Paper], limit: float) -> Iterator[Grade]:
    """Check papers one after another, each for at most ``limit`` real seconds, whatever becomes of them.

    Raises:
        BadLesson: the checks of a lesson cannot be used.
    """
    judges: dict[str, Judge] = {}
    for paper in papers:
        if paper.lesson is None or paper.file is None:
            yield Grade(paper)
            continue
        if not is_text(str(paper.file.resolve())):
            yield Grade(Paper(paper.learner, paper.lesson, problem="its path is not UTF-8; rename it"))
            continue
        if paper.lesson.id not in judges:
            judges[paper.lesson.id] = Judge(paper.lesson)
        yield Grade(paper, check(paper.lesson, judges[paper.lesson.id], paper.file, limit))


def table(graded: Sequence[Grade]) -> str:
    """Return grades as CSV: a learner and an exercise a line, with a column for each check."""
    most = max((grade.total for grade in graded), default=0)
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    checks = [f"check {number}" for number in range(1, most + 1)]
    rows.writerow(["learner", "lesson", "passed", "total", *checks, "problem"])
    for grade in graded:
        lesson = grade.paper.lesson
        cells = [*_results(grade), *[""] * most][:most]
        texts = [grade.paper.learner, "" if lesson is None else lesson.id]
        rows.writerow(map(_harmless, [*texts, str(grade.passed), str(grade.total), *cells, grade.problem]))
    return text.getvalue()


def line(grade: Grade) -> str:
    """Return a grade in a line for a terminal."""
    lesson = "" if grade.paper.lesson is None else f"  {grade.paper.lesson.id}"
    problem = f"  {grade.problem}" if grade.problem else ""
    return f"{grade.passed}/{grade.total}  {grade.paper.learner}{lesson}{problem}"


def _of_learner(folder: Path, exercises: Sequence[Lesson], only: Lesson | None) -> list[Paper]:
    try:
        files = sorted(path for path in folder.iterdir() if path.suffix == _PYTHON)
    except OSError as error:
        return [Paper(folder.name, only, problem=f"{folder} cannot be read: {error.strerror}")]
    wanted = exercises if only is None else [only]
    named = {path.name: path for path in files}
    found = [Paper(folder.name, each, named[each.file_name]) for each in wanted if each.file_name in named]
    if found:
        return found
    if only is not None and len(files) == 1:
        return [Paper(folder.name, only, files[0])]
    first, *others = (each.file_name for each in wanted)
    names = f"{first}, nor one of another exercise" if others else first
    return [Paper(folder.name, only, problem=f"{folder} has no file {names}")]


def _of_file(path: Path, exercises: Sequence[Lesson], only: Lesson | None) -> Paper:
    if only is not None:
        learner = _without(path.stem, only)
        return Paper(path.stem if learner is None else learner, only, path)
    for lesson in sorted(exercises, key=lambda each: -len(each.file_name)):
        learner = _without(path.stem, lesson)
        if learner is not None:
            return Paper(learner, lesson, path)
    return Paper(path.stem, problem=f"{path.name} does not tell by its name which exercise it is for")


def _without(stem: str, lesson: Lesson) -> str | None:
    """What a file's name has beside the lesson's; None where it does not have that."""
    name = lesson.file_name.removesuffix(_PYTHON)
    for rest in (stem.removeprefix(name), stem.removesuffix(name)):
        if rest != stem:
            return rest.strip("_-. ") or stem
    return None


def _results(grade: Grade) -> list[str]:
    if grade.checked is None:
        return []
    return [
        f"{'passed' if each.verdict.passed else 'failed'}: {each.check.asks}; {verdict_line(each)}"
        for each in grade.checked.judged
    ]


def _harmless(cell: str) -> str:
    """A cell that no spreadsheet takes for a formula: what a learner's program says can stand in it."""
    return f"'{cell}" if cell.lstrip(" ").startswith(("=", "+", "-", "@", "\t", "\r", "\n")) else cell
