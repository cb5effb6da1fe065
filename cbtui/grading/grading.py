"""Grades the files of many learners in isolation, so that none can change another's marks."""

import compileall
import hashlib
import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from cbtui.grading.confinement import PACKAGES, Confinement
from cbtui.grading.submission import BadSubmissionError, Submission, read_submission
from cbtui.grading.supervisor import Marks, mark
from cbtui.text.output import is_text
from lessons.judge import Judge
from lessons.lesson import Lesson
from sim.engine.setup import RealRos

_PYTHON = ".py"


class PackagesChangedError(Exception):
    """Files of cbtui or of a lesson have changed; the text is a sentence."""


@dataclass(frozen=True)
class HandIn:
    """The file that a learner handed in for an exercise; without a lesson or file, ``problem`` says why.

    ``folder`` is the learner's folder, if the file is in one.
    """

    learner: str
    lesson: Lesson | None = None
    file: Path | None = None
    problem: str = ""
    folder: Path | None = None


@dataclass(frozen=True, eq=False)
class LoadedHandIn:
    """A hand-in as it was read at the start; without a submission, ``problem`` says why it cannot be run."""

    paper: HandIn
    total: int = 0
    submission: Submission | None = None
    problem: str = ""

    @property
    def key(self) -> tuple[str, str, str]:
        """Learner, lesson id, and digest of the files."""
        lesson, submission = self.paper.lesson, self.submission
        digest = "" if submission is None else submission.digest
        return self.paper.learner, "" if lesson is None else lesson.id, digest


@dataclass(frozen=True)
class Grade:
    """The grade of a hand-in."""

    entry: LoadedHandIn
    marks: Marks

    @property
    def passed(self) -> int:
        """The number of passed checks."""
        return sum(passed for passed, _ in self.marks.checks)

    @property
    def good(self) -> bool:
        """Whether every check passed."""
        return 0 < self.entry.total == self.passed

    @property
    def suspicion(self) -> str:
        """Signs of a forged trace; empty if there are none."""
        return "; ".join(self.marks.doubts)


def hand_ins_in(folder: Path, exercises: Sequence[Lesson], only: Lesson | None) -> list[HandIn]:
    """Return the hand-ins in a folder, which has a folder or a file for each learner, in order of names.

    A file is recognised by its name: ``split_groups.py`` in a learner's folder, ``split_groups_ann.py`` or
    ``ann_split_groups.py`` beside others'. With ``only`` all is for that exercise, and a learner's only
    Python file may be called anything.

    Raises:
        OSError: the folder cannot be read.
    """
    papers: list[HandIn] = []
    for path in sorted(folder.iterdir()):
        if path.name.startswith((".", "__")):
            continue
        if path.is_symlink():
            papers.append(HandIn(path.name, only, problem=f"{path} is a link; put what it leads to there"))
        elif path.is_dir():
            papers += _of_learner(path, exercises, only)
        elif path.suffix == _PYTHON:
            papers.append(_of_file(path, exercises, only))
    return papers


class Grader:
    """Grades hand-ins that were all read at the start, so that a program cannot change other marks later.

    With ``real`` they run on that ROS 2.
    """

    def __init__(self, papers: Iterable[HandIn], real: RealRos | None = None) -> None:
        """Read the hand-ins.

        Raises:
            BadLesson: the checks of a lesson cannot be used.
        """
        self._real = real
        self.asked: dict[str, tuple[str, ...]] = {}
        """The questions of each lesson's checks, by the lesson's id."""
        self.entries = [self._entry(paper) for paper in papers]
        self._packages = _PackageFiles(entry.paper.lesson for entry in self.entries)
        self._on_disk = {entry: entry.key for entry in self.entries}

    @property
    def most_checks(self) -> int:
        """The number of checks of the exercise with the most checks."""
        return max(map(len, self.asked.values()), default=0)

    def grades(
        self,
        entries: Iterable[LoadedHandIn],
        limit: float,
        confinement: Confinement,
        watch: Callable[[], str | None],
    ) -> Iterator[Grade]:
        """Grade hand-ins one after another; ``limit`` is that of ``real_limit``.

        ``watch`` is called after each; it returns a sentence on a forbidden change, or None.

        Raises:
            PackagesChangedError: a program changed files of cbtui or of a lesson; its own grade came before.
        """
        for entry in entries:
            lesson, submission = entry.paper.lesson, entry.submission
            if lesson is None or submission is None:
                yield Grade(entry, Marks(trouble=entry.problem))
                continue
            marks = mark(submission, lesson, limit, confinement, self._real)
            packages = self._packages.changed()
            changed = [*packages[:1], *self._changed_papers()]
            seen = [f"{path} was changed while it ran" for path in changed] + [*filter(None, [watch()])]
            yield Grade(entry, _doubted(marks, seen))
            if packages:
                others = f" and {len(packages) - 1} more" if packages[1:] else ""
                raise PackagesChangedError(
                    f"{packages[0]}{others} changed while {submission.program} of {entry.paper.learner} ran, "
                    "and no marks would be right from here on; put cbtui and the lessons back as they were, "
                    "and go on with --resume"
                )

    def _entry(self, paper: HandIn) -> LoadedHandIn:
        if paper.lesson is None:
            return LoadedHandIn(paper, problem=paper.problem)
        if paper.lesson.id not in self.asked:
            self.asked[paper.lesson.id] = tuple(check.asks for check in Judge(paper.lesson).checks)
        total = len(self.asked[paper.lesson.id])
        if paper.file is None:
            return LoadedHandIn(paper, total, problem=paper.problem)
        if not is_text(paper.file.name):
            return LoadedHandIn(paper, total, problem="its path is not UTF-8; rename it")
        try:
            return LoadedHandIn(paper, total, read_submission(paper.file, paper.folder))
        except BadSubmissionError as error:
            return LoadedHandIn(paper, total, problem=str(error))

    def _changed_papers(self) -> Iterator[Path | None]:
        """Yield the files that have changed since the last call."""
        for entry in self.entries:
            key = self._entry(entry.paper).key
            if key != self._on_disk[entry]:
                self._on_disk[entry] = key
                yield entry.paper.file


class _PackageFiles:
    """Digests of the files of cbtui, of the engine and of lessons at construction."""

    def __init__(self, lessons: Iterable[Lesson | None]) -> None:
        own = [PACKAGES / name for name in ("cbtui", "lessons", "sim")]
        folders = {lesson.folder for lesson in lessons if lesson is not None}
        self._folders = [*own, *sorted(each for each in folders if not each.is_relative_to(PACKAGES))]
        for folder in self._folders:
            compileall.compile_dir(folder, quiet=2)  # so that no bytecode is written later
        self._digests = self._now()

    def changed(self) -> list[Path]:
        """Return the files that were changed, added or removed since construction."""
        now = self._now()
        paths = dict.fromkeys([*self._digests, *now])
        return [path for path in paths if self._digests.get(path) != now.get(path)]

    def _now(self) -> dict[Path, bytes]:
        return {
            path: _digest(path)
            for folder in self._folders
            for place, _, names in os.walk(folder)
            for path in (Path(place, name) for name in names)
        }


def _digest(path: Path) -> bytes:
    try:
        return hashlib.sha256(path.read_bytes()).digest()
    except OSError:
        return b""


def _doubted(marks: Marks, seen: Sequence[str]) -> Marks:
    return Marks(trouble=marks.trouble, doubts=(*marks.doubts, *seen)) if seen else marks


def line(grade: Grade) -> str:
    """Return a grade in a line for a terminal."""
    learner, lesson, _ = grade.entry.key
    suspicion = f"suspicious: {grade.suspicion}" if grade.suspicion else ""
    said = filter(None, [learner, lesson, grade.marks.trouble, suspicion])
    return " ".join("  ".join([f"{grade.passed}/{grade.entry.total}", *said]).splitlines())


def _of_learner(folder: Path, exercises: Sequence[Lesson], only: Lesson | None) -> list[HandIn]:
    try:
        files = sorted(path for path in folder.iterdir() if path.suffix == _PYTHON)
    except OSError as error:
        return [HandIn(folder.name, only, problem=f"{folder} cannot be read: {error.strerror}")]
    wanted = exercises if only is None else [only]
    named = {path.name: path for path in files}
    found = [
        HandIn(folder.name, each, named[each.file_name], folder=folder)
        for each in wanted
        if each.file_name in named
    ]
    if found:
        return found
    if only is not None and len(files) == 1:
        return [HandIn(folder.name, only, files[0], folder=folder)]
    first, *others = (each.file_name for each in wanted)
    names = f"{first}, nor one of another exercise" if others else first
    return [HandIn(folder.name, only, problem=f"{folder} has no file {names}")]


def _of_file(path: Path, exercises: Sequence[Lesson], only: Lesson | None) -> HandIn:
    if only is not None:
        learner = _without(path.stem, only)
        return HandIn(path.stem if learner is None else learner, only, path)
    for lesson in sorted(exercises, key=lambda each: -len(each.file_name)):
        learner = _without(path.stem, lesson)
        if learner is not None:
            return HandIn(learner, lesson, path)
    return HandIn(path.stem, problem=f"{path.name} does not tell by its name which exercise it is for")


def _without(stem: str, lesson: Lesson) -> str | None:
    """The part of a file's name beside the lesson's file name; None if it does not contain that."""
    name = lesson.file_name.removesuffix(_PYTHON)
    for rest in (stem.removeprefix(name), stem.removesuffix(name)):
        if rest != stem:
            return rest.strip("_-. ") or stem
    return None
