"""``cbtui``, ``cbtui open`` and ``cbtui replay``: the commands that open the console."""

import argparse
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from cbtui.commands.check import exercise_of
from cbtui.commands.in_lines import open_in_lines
from cbtui.commands.options import changes
from cbtui.commands.options.appearance import Appearance, add_options, appearance
from cbtui.commands.options.seeds import add_seed, check_seed
from cbtui.commands.options.targets import (
    file_of,
    is_file_name,
    is_recording,
    lesson_of,
    need_terminal,
    puzzle_of,
    refuse,
)
from cbtui.terminal.capabilities import is_dumb


def add_open_options(parser: argparse.ArgumentParser) -> None:
    """Give ``cbtui open`` its arguments."""
    parser.add_argument(
        "target",
        metavar="LESSON|PUZZLE|FILE.py",
        help="a lesson's number or id, a puzzle's id, see cbtui list, or a file: a program or a recording",
    )
    add_options(parser)
    changes.add_options(parser)
    add_seed(parser)
    changes.add_on(parser)
    changes.add_traceback(parser)
    parser.add_argument(
        "--exercise",
        action="store_true",
        help="open the lesson's exercise: your file in the current folder, checked whenever it is saved",
    )
    parser.add_argument(
        "--clock", choices=("virtual", "real"), help="which time a file runs on (real; with --seed virtual)"
    )


def add_replay_options(parser: argparse.ArgumentParser) -> None:
    """Give ``cbtui replay`` its arguments."""
    parser.add_argument("recording", metavar="FILE.mcap", help="a recording that cbtui made")
    add_options(parser)


def open_console(options: argparse.Namespace) -> int:
    """Open the console on its menu, a lesson, its exercise or a file; returns the exit code."""
    target: str | None = options.target
    if target is not None and options.exercise:
        return _open_exercise(options)
    if target is not None and is_recording(target):
        if changes.seeded_changes_of(options).words:
            refuse("a recording is shown as it is: leave out the options on threads and such")
        return _show_recording(options, target)
    start_file, lesson, puzzle = None, None, None
    if target is not None and is_file_name(target):
        check_seed(options.seed, options.clock)
        clock = options.clock or ("real" if options.seed is None else "virtual")
        start_file = (file_of(target), options.arguments, clock)
    elif target is not None and (puzzle := puzzle_of(target)) is not None:
        if changes.seeded_changes_of(options).words:
            refuse("a puzzle is run as it is: leave out the options on threads and such")
    elif target is not None:
        opened = lesson_of(target, or_file=True)
        check_seed(options.seed, opened.setup.clock)
        lesson = opened.id
    look = console_look(options, "cbtui run")
    changed = None if target is None else changes.seeded_changes_of(options)
    return run_console(
        look, start_lesson=lesson, start_puzzle=puzzle, start_file=start_file, start_changes=changed
    )


def _open_exercise(options: argparse.Namespace) -> int:
    from dataclasses import replace

    lesson = exercise_of(options.target)
    changed = changes.seeded_changes_of(options)
    if replace(changed, real=None).words:
        refuse(
            "an exercise is run as your file says: change that, and leave out the options on threads and such"
        )
    look = console_look(options, "cbtui check")
    return run_console(look, start_exercise=lesson.id, start_changes=changed)


def replay(options: argparse.Namespace) -> int:
    """Open the console on a recording; returns the exit code."""
    return _show_recording(options, options.recording)


def _show_recording(options: argparse.Namespace, name: str) -> int:
    from sim.recording import RecordingError, read

    try:
        recording = read(Path(name))
    except (RecordingError, ValueError) as error:
        refuse(str(error))
    return run_console(console_look(options, "cbtui info"), start_recording=recording)


def console_look(options: argparse.Namespace, instead: str) -> Appearance:
    """Return the appearance by the options; exits with code 2 where a console cannot be drawn.

    ``instead`` is the command that needs no terminal.
    """
    with _opening():  # the looks are Textual's, which takes a while to import
        look = appearance(options)
    if not look.screen_reader:
        need_terminal(instead)
    return look


def run_console(look: Appearance, **begins_with: Any) -> int:
    """Run the console with an appearance, on the screen or in lines; returns the exit code.

    The other arguments are ``CbtuiApp``'s own.
    """
    from lessons.catalogue import faults  # before the console takes over the terminal

    look = look._replace(complaints=[*look.complaints, *map(str, faults())])
    if look.screen_reader:
        return open_in_lines(look, **begins_with)
    with _opening():
        from cbtui.app import CbtuiApp

        if any(each is not None for each in begins_with.values()):
            import cbtui.screens.lesson  # noqa: F401 -- here, for once the app runs the screen is empty

        app = CbtuiApp(
            charset=look.charset, theme=look.theme, keys=look.keys, complaints=look.complaints, **begins_with
        )
        app.run()
    return app.return_code or 0


@contextmanager
def _opening() -> Iterator[None]:
    """Say in the terminal's last line that something is opened, and leave no trace of it at the end.

    The console draws on a screen of its own, and only once it has imported what it needs.
    """
    _write("opening ...\r")
    try:
        yield
    finally:
        _write(_CLEAR_LINE)


def _write(text: str) -> None:
    with suppress(OSError):  # the console tells of a terminal that is gone
        if sys.stderr.isatty() and not is_dumb(os.environ):
            sys.stderr.write(text)
            sys.stderr.flush()


_CLEAR_LINE = "\x1b[K"
