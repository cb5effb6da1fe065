"""Creates a new lesson from a small, valid template."""

import re
import shutil
from pathlib import Path

from lessons.catalogue import ROOT
from lessons.lesson import DESCRIPTION_FILE, GUIDE_FILE

TEMPLATE = ROOT / "scaffold"
"""The template lesson, which is in no catalogue."""
_ID = re.compile(r"[a-z0-9]+(-[a-z0-9]+)*")
_TITLE = "Scaffold"


class CannotScaffoldError(Exception):
    """A lesson cannot be created; the text is a sentence."""


def make_lesson(folder: Path) -> list[Path]:
    """Create a folder with a lesson of its name; returns the lesson's files.

    Raises:
        CannotScaffoldError: the name is no id or is taken, or the folder exists or cannot be created.
    """
    folder = folder.absolute()
    if not _ID.fullmatch(folder.name):
        raise CannotScaffoldError(
            f"{folder.name!r} cannot be a lesson's id; take small letters and digits, joined by '-'"
        )
    if any(ROOT.glob(f"unit*/{folder.name}/{DESCRIPTION_FILE}")):
        raise CannotScaffoldError(f"cbtui has a lesson {folder.name!r} already; take another name")
    try:
        folder.mkdir(parents=True)
    except FileExistsError:
        raise CannotScaffoldError(f"{folder} is there already; nothing was written") from None
    except OSError as error:
        raise CannotScaffoldError(f"{folder} cannot be made: {error.strerror}") from None
    try:
        for file in sorted(path for path in TEMPLATE.iterdir() if path.is_file()):
            shutil.copyfile(file, folder / file.name)
        title = folder.name.replace("-", " ").capitalize()
        for name, old, new in (
            (DESCRIPTION_FILE, f'id = "{TEMPLATE.name}"', f'id = "{folder.name}"'),
            (DESCRIPTION_FILE, f'title = "{_TITLE}"', f'title = "{title}"'),
            (GUIDE_FILE, f"# {_TITLE}\n", f"# {title}\n"),
        ):
            path = folder / name
            path.write_text(path.read_text(encoding="utf-8").replace(old, new, 1), encoding="utf-8")
    except BaseException as error:
        shutil.rmtree(folder, ignore_errors=True)
        if isinstance(error, OSError):
            raise CannotScaffoldError(f"{folder} cannot be made: {error.strerror}") from None
        raise
    return sorted(folder.iterdir())
