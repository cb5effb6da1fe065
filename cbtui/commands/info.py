"""``cbtui info``: what is in a recording."""

import argparse
from pathlib import Path


def add_options(parser: argparse.ArgumentParser) -> None:
    """Give the command its arguments."""
    parser.add_argument("recording", metavar="FILE.mcap", help="a recording that cbtui made")


def info(options: argparse.Namespace) -> int:
    """Tell what a recording holds; returns the exit code."""
    from cbtui.runs.recorded.recording_summary import tell

    return tell(Path(options.recording))
