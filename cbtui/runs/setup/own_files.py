"""A learner's own programs and recordings: from a typed path to the entry to open."""

import os
from collections.abc import Sequence
from itertools import islice
from pathlib import Path
from stat import S_ISDIR, S_ISREG
from typing import TYPE_CHECKING, NamedTuple

from cbtui.runs.setup.recent import RecentEntry, RecentKind
from sim.files.untrusted import mode_of

if TYPE_CHECKING:
    from sim.recording import Recording

PROGRAMS = (".py", ".xml", ".yaml", ".yml")
"""The name endings of node and launch files."""
RECORDINGS = (".mcap",)
_SCAN_LIMIT = 5000
"""Names of a folder that are examined for a completion."""


class CannotOpenError(Exception):
    """A file that cannot be opened; the text is a sentence."""


class PathCompletion(NamedTuple):
    """The text completed by the common beginning of all candidates, and these; folders end in a slash."""

    text: str
    names: Sequence[str]


def entry_for(text: str, at: float) -> RecentEntry:
    """Return the entry for a typed path; ``at`` is the current time in seconds since 1970.

    Raises:
        CannotOpenError: there is no such file, or it is nothing that can be opened.
    """
    typed = text.strip()
    if not typed:
        raise CannotOpenError("Type the path of a program (.py, or a launch file) or of a recording (.mcap).")
    path = _expanded(typed)
    kind = _kind_of(path)
    check(path)
    if kind is None:
        raise CannotOpenError(
            f"{typed} is neither a program (.py, or a launch file) nor a recording (.mcap), by its name."
        )
    return RecentEntry(kind, str(path.absolute()), int(at))


def check(path: Path) -> None:
    """Check that there is a readable file.

    Raises:
        CannotOpenError: there is none.
    """
    try:
        mode = mode_of(path)
        if S_ISDIR(mode):
            raise CannotOpenError(f"{path} is a folder; name the file in it to open.")
        if not mode:
            raise CannotOpenError(f"There is no file {path}.")
        if not S_ISREG(mode):
            raise CannotOpenError(f"{path} is not a file.")
    except (OSError, ValueError) as error:
        raise CannotOpenError(f"{path} cannot be opened: {getattr(error, 'strerror', error)}.") from None
    if not os.access(path, os.R_OK):
        raise CannotOpenError(f"You may not read {path}.")


def read_recording(path: Path) -> "Recording":
    """Return a recording to be read.

    Raises:
        CannotOpenError: it is not such a file.
    """
    from sim.recording import RecordingError, read

    try:
        return read(path)
    except (RecordingError, ValueError) as error:
        raise CannotOpenError(f"{error}.") from None


def completed(text: str) -> PathCompletion:
    """Complete a path as far as it is unambiguous; folders and files that can be opened count."""
    folder, beginning = os.path.split(text)
    names = _names(_expanded(folder or "."), beginning)
    if not names:
        return PathCompletion(text, ())
    common = os.path.commonprefix(names)  # noqa: RUF071 -- letter by letter
    return PathCompletion(os.path.join(folder, common), names)  # noqa: PTH118 - as typed


def _names(folder: Path, beginning: str) -> list[str]:
    try:
        with os.scandir(folder) as found:
            every = [
                f"{entry.name}/" if entry.is_dir() else entry.name for entry in islice(found, _SCAN_LIMIT)
            ]
    except (OSError, ValueError):
        return []
    wanted = [name for name in every if name.startswith(beginning) and (beginning or name[0] != ".")]
    return sorted(name for name in wanted if name.endswith(("/", *PROGRAMS, *RECORDINGS)))


def _kind_of(path: Path) -> RecentKind | None:
    if path.suffix.lower() in RECORDINGS:
        return RecentKind.RECORDING
    return RecentKind.PROGRAM if path.suffix.lower() in PROGRAMS else None


def _expanded(text: str) -> Path:
    try:
        return Path(text).expanduser()
    except RuntimeError:  # the user has no home folder
        return Path(text)
