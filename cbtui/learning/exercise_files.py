"""The learner's file for an exercise: created from the starter, and never overwritten."""

from dataclasses import dataclass
from enum import Enum
from pathlib import Path

from lessons.lesson import Lesson
from sim.files.atomic import write_atomically
from sim.files.untrusted import read_bytes
from sim.quantities.plural import counted


class StarterPlacement(Enum):
    """The result of placing a starter file."""

    NEW = "new"
    THERE_ALREADY = "there already"
    """The unchanged starter was there; nothing was written."""
    CHANGED = "changed"
    """Another file of that name was there; nothing was written."""


class CannotPlaceError(Exception):
    """A starter cannot be placed; the text is a sentence."""


@dataclass(frozen=True)
class ExerciseFile:
    """The learner's file, and a sentence on where it is and whether it is new."""

    path: Path
    sentence: str


_SENTENCES = {
    StarterPlacement.NEW: "{name} is yours now, in {folder}: it is checked whenever you save it.",
    StarterPlacement.THERE_ALREADY: (
        "{name} is in {folder} already, unchanged: it is checked whenever you save it."
    ),
    StarterPlacement.CHANGED: "Your {name} in {folder} is kept as it is: it is checked whenever you save it.",
}


def own_file(lesson: Lesson, folder: Path) -> ExerciseFile:
    """Return the learner's file for a lesson's exercise in a folder, created from the starter if missing.

    Raises:
        CannotPlaceError: as ``place_starter``, or something else than a file has that name.
    """
    path = folder / lesson.file_name
    placed = place_starter(lesson, folder)
    if not path.is_file():
        raise CannotPlaceError(f"{path} is there already, and is not a file")
    return ExerciseFile(path, _SENTENCES[placed].format(name=path.name, folder=folder))


def before_the_solution(hints_left: int) -> str:
    """Return the question to a learner who asks for the solution."""
    said = "You remember longer what you find out yourself."
    if hints_left:
        said += f" {counted(hints_left, 'hint')} {'is' if hints_left == 1 else 'are'} left."
    return said


def place_starter(lesson: Lesson, folder: Path) -> StarterPlacement:
    """Put the starter of a lesson's exercise into a folder, as ``lesson.file_name``.

    Raises:
        CannotPlaceError: the lesson has no exercise, or the folder is missing or takes no files.
    """
    starter = lesson.starter_path
    if starter is None:
        raise CannotPlaceError(f"the lesson {lesson.id} has no exercise")
    path = folder / lesson.file_name
    content = starter.read_bytes()
    try:
        if not folder.is_dir():
            raise CannotPlaceError(f"there is no folder {folder}")
        write_atomically(path, content, replace=False)
    except FileExistsError:
        return _there(path, content)
    except OSError as error:
        raise CannotPlaceError(f"{path} cannot be written: {error.strerror}") from None
    return StarterPlacement.NEW


def _there(path: Path, content: bytes) -> StarterPlacement:
    try:
        same = read_bytes(path) == content
    except OSError:
        same = False
    return StarterPlacement.THERE_ALREADY if same else StarterPlacement.CHANGED
