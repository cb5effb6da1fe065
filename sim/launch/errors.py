"""Errors of launch files, each in one sentence with the file's name and line."""

from __future__ import annotations

import sys
import traceback
from pathlib import Path
from types import FrameType

from sim.packages import PackageError

_HERE = str(Path(__file__).parent)


class LaunchError(Exception):
    """A launch file cannot be read or carried out; the text says where and why."""


Place = tuple[str, int]
"""A file and a line of it."""


def place_of_caller() -> Place | None:
    """Return the nearest line on the stack outside this package: where a launch file creates an action."""
    frame: FrameType | None = sys._getframe(1)
    while frame is not None:
        name = frame.f_code.co_filename
        if not name.startswith((_HERE, "<")):
            return name, frame.f_lineno
        frame = frame.f_back
    return None


def explained(error: BaseException, file: Path, place: Place | None = None) -> LaunchError:
    """Return ``error`` as a sentence on the line of ``file`` that raised it, else on ``place``."""
    if isinstance(error, LaunchError):
        return error
    if isinstance(error, SyntaxError) and error.filename == str(file):
        return LaunchError(f"{file.name}:{error.lineno}: {error.msg}")
    for frame, line in traceback.walk_tb(error.__traceback__):
        if frame.f_code.co_filename == str(file):
            place = (str(file), line)
    where = file.name if place is None else f"{Path(place[0]).name}:{place[1]}"
    return LaunchError(f"{where}: {_text(error)}")


def _text(error: BaseException) -> str:
    text = " ".join(str(error).split())
    if isinstance(error, _CLEAR):
        return text
    return f"{type(error).__name__}: {text}" if text else type(error).__name__


class LaunchFailure(RuntimeError):  # noqa: N818 -- base of exceptions that launch names
    """An action or substitution failed; the text is a sentence."""


COMPILED = ": components are compiled from C++"


def unsupported(name: str, why: str) -> type:
    """Return a class by that name whose constructor raises NotImplementedError with the reason."""

    def refuse(*_: object, **__: object) -> None:
        raise NotImplementedError(f"{name} is not supported{why}")

    return type(name, (), {"__init__": refuse})


_CLEAR = (LaunchFailure, PackageError, NotImplementedError, ImportError)
