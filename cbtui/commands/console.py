"""``cbtui``, ``cbtui open``, ``cbtui replay``: what opens the console."""

import argparse
from pathlib import Path

from cbtui.commands.targets import file_of, is_file_name, lesson_of, need_terminal, refuse

_CHARSETS = ("braille", "block", "ascii")


def add_options(parser: argparse.ArgumentParser) -> None:
    """Give the command the options of everything that opens the console."""
    parser.add_argument(
        "--charset", choices=_CHARSETS, default="braille", help="what the screen is drawn with (%(default)s)"
    )


def add_open_options(parser: argparse.ArgumentParser) -> None:
    """Give ``cbtui open`` its arguments."""
    parser.add_argument("target", metavar="LESSON|FILE.py", help="a lesson's id, see cbtui list, or a file")
    add_options(parser)
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
    need_terminal("cbtui run")
    from cbtui.app import CbtuiApp

    CbtuiApp(charset=options.charset, start_lesson=lesson, start_file=start_file).run()
    return 0


def replay(options: argparse.Namespace) -> int:
    """Open the console on a recording; returns the exit code."""
    from sim.trace.recording import RecordingError, read

    try:
        recording = read(Path(options.recording))
    except (RecordingError, ValueError) as error:
        refuse(str(error))
    need_terminal("cbtui info")
    from cbtui.app import CbtuiApp

    CbtuiApp(charset=options.charset, start_recording=recording).run()
    return 0
