"""``cbtui``, ``cbtui open``, ``cbtui replay``: what opens the console."""

import argparse
from pathlib import Path

from cbtui.commands import changes
from cbtui.commands.appearance import add_options, appearance, console_of
from cbtui.commands.targets import file_of, is_file_name, lesson_of, need_terminal, refuse


def add_open_options(parser: argparse.ArgumentParser) -> None:
    """Give ``cbtui open`` its arguments."""
    parser.add_argument("target", metavar="LESSON|FILE.py", help="a lesson's id, see cbtui list, or a file")
    add_options(parser)
    changes.add_options(parser)
    parser.add_argument(
        "--clock", choices=("virtual", "real"), default="real", help="which time a file runs on (%(default)s)"
    )


def add_replay_options(parser: argparse.ArgumentParser) -> None:
    """Give ``cbtui replay`` its arguments."""
    parser.add_argument("recording", metavar="FILE.mcap", help="a recording that cbtui made")
    add_options(parser)


def open_console(options: argparse.Namespace) -> int:
    """Open the console on its menu, a lesson or a file; returns the exit code."""
    target: str | None = options.target
    start_file, lesson = None, None
    if target is not None and is_file_name(target):
        start_file = (file_of(target), options.arguments, options.clock)
    elif target is not None:
        lesson = lesson_of(target).id
    look = appearance(options)
    need_terminal("cbtui run")
    _read_lessons()
    changed = None if target is None else changes.changes_of(options)
    console_of(look, start_lesson=lesson, start_file=start_file, start_changes=changed).run()
    return 0


def _read_lessons() -> None:
    """Find a lesson that is at fault before the console takes the screen."""
    from lessons.catalogue import lessons

    lessons()


def replay(options: argparse.Namespace) -> int:
    """Open the console on a recording; returns the exit code."""
    from sim.trace.recording import RecordingError, read

    try:
        recording = read(Path(options.recording))
    except (RecordingError, ValueError) as error:
        refuse(str(error))
    look = appearance(options)
    need_terminal("cbtui info")
    console_of(look, start_recording=recording).run()
    return 0
