"""Questions about a program's file, each answered once for each text that the file has."""

from collections.abc import Callable
from functools import lru_cache, wraps
from pathlib import Path
from typing import TypeVar, TypeVarTuple

from sim.diagnosis.edits.source_editor import NotSimpleError, SourceEditor
from sim.files.untrusted import program_text

_More = TypeVarTuple("_More")
_Answer = TypeVar("_Answer")


def asked_of_file(
    question: Callable[[SourceEditor, *_More], _Answer],
) -> Callable[[str, *_More], _Answer]:
    """Let a question about a source be asked with the path of a file, which is read when it has changed.

    A file that cannot be read, or is not Python, counts as an empty one. The source is not to be edited.
    """
    answer = lru_cache(maxsize=256)(question)

    @wraps(question)
    def asked(file: str, /, *more: *_More) -> _Answer:
        return answer(_source(_version(file)), *more)

    return asked


@lru_cache(maxsize=16)
def _source(version: tuple[str, *tuple[int, ...]]) -> SourceEditor:
    try:
        return SourceEditor(program_text(Path(version[0])) or "")
    except NotSimpleError:
        return SourceEditor("")


def _version(file: str) -> tuple[str, *tuple[int, ...]]:
    try:
        found = Path(file).stat()
    except (OSError, ValueError):  # a file's name has no null character
        return (file,)
    return file, found.st_ino, found.st_size, found.st_mtime_ns, found.st_ctime_ns
