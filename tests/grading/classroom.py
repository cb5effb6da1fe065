"""A lesson of its own, and a folder with what learners handed in for it, graded as a teacher would."""

import csv
import os
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from cbtui.learning.lesson_scaffold import make_lesson
from tests.grading.forgeries import SOLUTION, Targets, written

LESSON = "blinking"
NEIGHBOURS = ("ann", "zoe")
"""Who have the solution, and come first and last."""
_TIMEOUT = 400


@dataclass(frozen=True)
class Graded:
    """What came of it."""

    code: int
    rows: Mapping[str, Mapping[str, str]]
    out: str
    err: str


class Classroom:
    """Everything in one folder; ``confined``: with bwrap, which has to be there."""

    def __init__(self, place: Path, *, confined: bool) -> None:
        self.lesson = place / "course" / LESSON
        self.homework = place / "homework"
        self.table = place / "marks.csv"
        self._empty = place / "bin"
        self.confined = confined
        for folder in (self.homework, self._empty):
            folder.mkdir(parents=True)
        make_lesson(self.lesson)
        for name in NEIGHBOURS:
            self.hand_in(name, SOLUTION)

    @property
    def targets(self) -> Targets:
        """What is within reach of a program without namespaces."""
        neighbour = self.homework / "ann" / f"{LESSON}.py"
        return Targets(self.lesson / "checks.py", self.lesson / "solution.py", neighbour, self.table)

    def hand_in(self, learner: str, source: str) -> Path:
        """Put a learner's file where it belongs."""
        file = self.homework / learner / f"{LESSON}.py"
        file.parent.mkdir(exist_ok=True)
        file.write_text(written(source, self.targets))
        return file

    def grade(self, *options: str, limit: float = 20) -> Graded:
        """Run ``cbtui grade`` on it."""
        words = ["grade", str(self.homework), "--lessons", str(self.lesson.parent), "--csv", str(self.table)]
        path = os.environ["PATH"] if self.confined else str(self._empty)
        done = subprocess.run(
            [sys.executable, "-m", "cbtui", *words, "--limit", str(limit), *options],
            capture_output=True,
            text=True,
            timeout=_TIMEOUT,
            check=False,
            stdin=subprocess.DEVNULL,
            env={**os.environ, "PATH": path},
        )
        return Graded(done.returncode, self.rows(), done.stdout, done.stderr)

    def rows(self) -> dict[str, dict[str, str]]:
        """The table, by learner."""
        with self.table.open(newline="") as file:
            return {row["learner"]: row for row in csv.DictReader(file)}
