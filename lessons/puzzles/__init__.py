"""Puzzles: the learner chooses which thread goes on, until a node shows what the puzzle asks for.

A folder a puzzle: ``node.py``, and ``puzzle.toml`` with its goal and a solution.
"""

from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

if TYPE_CHECKING:
    from lessons.checks import Check

SECONDS = 0.19
"""How long a puzzle's run lasts, in its own time."""


class Goal(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What is to be brought about: one of these."""

    raises: str = ""
    """A callback that is to raise."""
    says: str = ""
    """What is to stand in the log."""
    deadlock: bool = False

    def check(self) -> "Check":
        """Return the check that passes once it was brought about."""
        from lessons.checks import gets_stuck, log_says, raises  # the menu needs none

        if self.raises:
            return raises(self.raises)
        return log_says(self.says) if self.says else gets_stuck()


class Puzzle(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A puzzle; ``lesson`` is the id of the one that it belongs to, ``solution`` a seed of moves."""

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
