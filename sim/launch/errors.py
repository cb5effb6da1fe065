"""What can be wrong with a launch file, in one sentence with its name and line."""

from __future__ import annotations

import sys
import traceback
from pathlib import Path
from types import FrameType

from sim.packages import PackageError

_HERE = str(Path(__file__).parent)


class LaunchError(Exception):
    """A launch file that cannot be read or carried out; the text says where and why."""


Place = tuple[str, int]
"""A file and a line of it."""


def place_of_caller() -> Place | None:
    """The nearest line on the stack that is not this package's own: where a launch file makes an action."""
    frame: FrameType | None = sys._getframe(1)
    while frame is not None:
        name = frame.f_code.co_filename
        if not name.startswith((_HERE, "<")):
            return name, frame.f_lineno
        frame = frame.f_back
    return None


def explained(error: BaseException, file: Path, place: Place | None = None) -> LaunchError:
    """``error`` as a sentence on the line of ``file`` it came from, else on ``place``."""
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


class LaunchFailure(RuntimeError):  # noqa: N818 -- base of exceptions whose names launch gives
    """An action or substitution that cannot do what it is asked; the text is a sentence of its own."""


COMPILED = ": components are compiled from C++"


def unsupported(name: str, why: str) -> type:
    """A class by that name of which nobody can make one: NotImplementedError tells why."""

    def refuse(*_: object, **__: object) -> None:
        raise NotImplementedError(f"{name} is not supported{why}")

    return type(name, (), {"__init__": refuse})


_CLEAR = (LaunchFailure, PackageError, NotImplementedError, ImportError)
