"""A learner's own file for an exercise: put where they work, and never over what they have written."""

from enum import Enum
from pathlib import Path

from lessons.lesson import Lesson


class Placed(Enum):
    """What became of putting a starter somewhere."""

    NEW = "new"
    THERE_ALREADY = "there already"
    """As it was put there before; nothing was written."""
    CHANGED = "changed"
    """A file of that name with something else in it is there; nothing was written."""


class CannotPlaceError(Exception):
    """A starter that cannot be put somewhere; the text is a sentence."""


def place_starter(lesson: Lesson, folder: Path) -> Placed:
    """Put the starter of a lesson's exercise into a folder, as ``lesson.file_name``.

    Raises:
        CannotPlaceError: the lesson has no exercise, or the folder is not there or takes no files.
    """
    starter = lesson.starter_path
    if starter is None:
        raise CannotPlaceError(f"the lesson {lesson.id} has no exercise")
    if not folder.is_dir():
        raise CannotPlaceError(f"there is no folder {folder}")
    path = folder / lesson.file_name
    content = starter.read_bytes()
    try:
        with path.open("xb") as file:
            file.write(content)
    except FileExistsError:
        return _there(path, content)
    except OSError as error:
        raise CannotPlaceError(f"{path} cannot be written: {error.strerror}") from None
    return Placed.NEW


def _there(path: Path, content: bytes) -> Placed:
    try:
        same = path.read_bytes() == content
    except OSError:
        same = False
    return Placed.THERE_ALREADY if same else Placed.CHANGED
