"""Puzzles: the learner chooses which thread goes on, until the goal is reached.

Each puzzle is a folder with ``node.py``, and ``puzzle.toml`` with its goal and a solution.
"""

from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

if TYPE_CHECKING:
    from lessons.checks import Check

SECONDS = 0.19
"""The length of a puzzle's run, in its own time."""


class Goal(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The goal of a puzzle: one of these fields."""

    raises: tuple[str, ...] = ()
    """Callbacks of which one has to raise."""
    says: str = ""
    """A text that has to be in the log."""
    deadlock: bool = False

    def check(self) -> "Check":
        """Return the check that passes once the goal is reached."""
        from lessons.checks import gets_stuck, log_says, raises  # not needed by the menu

        if self.raises:
            return raises(*self.raises)
        return log_says(self.says) if self.says else gets_stuck()


class Puzzle(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A puzzle; ``lesson`` is the id of its lesson, ``solution`` a seed of moves."""

    title: str
    lesson: str
    task: str
    goal: Goal
    solution: str
    id: str = ""

    @property
    def node_path(self) -> Path:
        """The file of its node."""
        return Path(__file__).with_name(self.id) / "node.py"


def puzzles_of(lesson: str) -> list[Puzzle]:
    """Return the puzzles that belong to a lesson, by its id."""
    return [puzzle for puzzle in puzzles() if puzzle.lesson == lesson]


@cache
def puzzles() -> tuple[Puzzle, ...]:
    """Return all puzzles, in order of their ids."""
    files = sorted(Path(__file__).parent.glob("*/puzzle.toml"))
    return tuple(
        msgspec.structs.replace(msgspec.toml.decode(each.read_bytes(), type=Puzzle), id=each.parent.name)
        for each in files
    )
