"""The lesson or files that a command runs; wrong targets exit with code 2 and one line."""

import os
import sys
from collections.abc import Sequence
from pathlib import Path
from stat import S_ISDIR, S_ISREG
from typing import TYPE_CHECKING, NamedTuple, NoReturn

from cbtui.terminal.capabilities import is_browser, is_dumb
from cbtui.text.output import complain, is_text
from sim.files.untrusted import mode_of

if TYPE_CHECKING:
    from lessons.lesson import Lesson
    from lessons.puzzles import Puzzle

RECORDING = ".mcap"
"""The name ending of a recording."""
_PROGRAMS = (".py", ".xml", ".yaml", ".yml")
"""The name endings of node and launch files."""


def lesson_of(name: str, *, or_file: bool = False) -> "Lesson":
    """Return the lesson with that id; exits with code 2 and one line if there is none.

    That line is about the file or folder of that name, if there is one and it could be meant (``or_file``).
    """
    from lessons.catalogue import UnknownLesson, find

    _refuse_recording(name)
    try:
        return find(name)
    except UnknownLesson as error:
        if or_file and os.path.lexists(name):
            file_of(name)
        refuse(str(error))


def puzzle_of(name: str) -> "Puzzle | None":
    """Return the puzzle with that id, if there is one."""
    from lessons.puzzles import puzzles

    return next((puzzle for puzzle in puzzles() if puzzle.id == name), None)


def refuse(sentence: str) -> NoReturn:
    """Print a sentence and exit with code 2."""
    complain(sentence)
    raise SystemExit(2)


def need_terminal(instead: str) -> None:
    """Exit if there is no usable terminal; ``instead`` is the command that needs none."""
    if is_browser(os.environ):
        return
    if not (sys.stdin.isatty() and sys.stdout.isatty()):
        refuse(f"the console needs a terminal; use {instead} where there is none")
    if not sys.stderr.isatty():
        refuse("the console draws on standard error; leave that to the terminal, without 2>")
    if is_dumb(os.environ):
        refuse(f"this terminal (TERM={os.environ['TERM']}) cannot place its cursor; use {instead}")


class RunTargets(NamedTuple):
    """The lesson or the files that a command's targets name."""

    lesson: "Lesson | None"
    files: list[Path]


def targets_of(targets: Sequence[str]) -> RunTargets:
    """Return the lesson or the files of some targets; neither if there are no targets."""
    if not targets or is_file_name(targets[0]):
        for name in targets[1:]:
            if not is_file_name(name) and not os.path.lexists(name):
                refuse(f"there is no file {name}; for an argument of the program, put -- before it")
        return RunTargets(None, [file_of(name) for name in targets])
    lesson = lesson_of(targets[0], or_file=True)
    if len(targets) > 1:
        refuse("one lesson runs at a time; several targets must all be files")
    return RunTargets(lesson, [])


def is_file_name(target: str) -> bool:
    """Tell whether a target names a file rather than a lesson."""
    return target.endswith(_PROGRAMS) or "/" in target


def is_recording(name: str) -> bool:
    """Whether a file is a recording, by its name."""
    return name.endswith(RECORDING)


def _refuse_recording(name: str) -> None:
    if is_recording(name):
        refuse(f"{name} is a recording, which nothing runs; cbtui replay {name} shows it")


def file_of(name: str) -> Path:
    """Return the program file of that name; exits with code 2 and one line if there is none."""
    path = Path(name)
    _refuse_recording(name)
    try:
        mode = mode_of(path)
        if S_ISDIR(mode):
            refuse(f"{name} is a folder; name the file in it to run")
        if not mode:
            from difflib import get_close_matches  # only needed for a wrong name

            beside = [each.name for each in path.parent.glob("*") if is_file_name(each.name)]
            nearest = get_close_matches(path.name, beside, 1, 0.8)
            near = f"the nearest is {nearest[0]}; " if nearest else ""
            refuse(f"there is no file {name}; {near}give a Python file, or a lesson of cbtui list")
        if not S_ISREG(mode):
            refuse(f"{name} is a pipe or a device; give a file, which can be read more than once")
    except OSError as error:
        refuse(f"{name} cannot be opened: {error.strerror}")
    if not name.endswith(_PROGRAMS):
        refuse(f"{name} is no program, by its name; give a Python file (.py) or a launch file")
    if not is_text(str(path.resolve())):
        refuse(f"{name}: its name and its folders' names have to be UTF-8; rename it")
    return path


def folder_of(name: str) -> Path:
    """Return the folder of that name; exits with code 2 and one line if there is none."""
    path = Path(name)
    try:
        mode = mode_of(path)
        if not S_ISDIR(mode):
            refuse(f"{name} is not a folder" if mode else f"there is no folder {name}")
    except OSError as error:
        refuse(f"{name} cannot be opened: {error.strerror}")
    return path


def same_file(one: Path, other: Path) -> bool:
    """Tell whether two paths name the same file, which need not exist yet."""
    try:
        return one.samefile(other)
    except OSError:
        return os.path.realpath(one) == os.path.realpath(other)
