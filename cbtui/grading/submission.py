"""A submission: a learner's files, read once into memory and written to the copy that is run."""

import hashlib
import os
import stat
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

_MOST_BYTES = 16_000_000
_MOST_FILES = 1_000
_SKIPPED = (".", "__pycache__")


class BadSubmissionError(Exception):
    """A submission cannot be graded; the text is a sentence."""


@dataclass(frozen=True)
class Submission:
    """The files of a submission by their paths in its folder; ``program`` is the one that is run."""

    program: str
    files: Mapping[str, bytes]

    @cached_property
    def digest(self) -> str:
        """A digest that is equal for submissions with the same files."""
        digest = hashlib.sha256(self.program.encode(errors="surrogateescape"))
        for name, content in sorted(self.files.items()):
            digest.update(f"\0{name}\0{len(content)}\0".encode(errors="surrogateescape") + content)
        return digest.hexdigest()[:16]

    def write_to(self, folder: Path) -> Path:
        """Write the files into a folder; returns the path of the program."""
        for name, content in self.files.items():
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
        return folder / self.program


def read_submission(program: Path, folder: Path | None) -> Submission:
    """Read a program and, if ``folder`` is given, all files in that except links.

    Raises:
        BadSubmissionError: the program is a link or not a file, a file is unreadable, or the size is too
        large.
    """
    files: dict[str, bytes] = {}
    try:
        for path in [program] if folder is None else [program, *_files_in(folder)]:
            content = _content(path, _MOST_BYTES - sum(map(len, files.values())))
            if content is not None:
                files[str(path.relative_to(folder or program.parent))] = content
            elif path == program:
                raise BadSubmissionError(f"{program} is a link or no file; put the file itself there")
            if len(files) > _MOST_FILES:
                raise BadSubmissionError(f"{folder} has more than {_MOST_FILES} files in it")
    except OSError as error:
        raise BadSubmissionError(f"{error.filename} cannot be read: {error.strerror}") from None
    return Submission(program.name, files)


def _files_in(folder: Path) -> Iterator[Path]:
    for place, folders, names in os.walk(folder, onerror=_raise):
        folders[:] = sorted(name for name in folders if not name.startswith(_SKIPPED))
        yield from (Path(place, name) for name in sorted(names) if not name.startswith(_SKIPPED))


def _raise(error: OSError) -> None:
    raise error


def _content(path: Path, room: int) -> bytes | None:
    """A file's content; None for a link, a pipe or a device."""
    if not stat.S_ISREG(path.lstat().st_mode):
        return None
    with open(os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK), "rb") as file:  # noqa: PTH123
        content = file.read(room + 1)
    if len(content) > room:
        raise BadSubmissionError(f"{path}: a submission has at most {_MOST_BYTES // 1_000_000} MB")
    return content
