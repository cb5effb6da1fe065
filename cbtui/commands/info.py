"""``cbtui info``: summarises a recording."""

import argparse
from pathlib import Path

from cbtui.commands.run import add_chain


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("recording", metavar="FILE.mcap", help="a recording that cbtui made")
    add_chain(parser)
    parser.add_argument(
        "--json", action="store_true", help="print the run's summary and diagnosis as JSON instead"
    )


def info(options: argparse.Namespace) -> int:
    """Print a summary of a recording; returns the exit code."""
    from cbtui.runs.recorded.recording_summary import tell

    return tell(Path(options.recording), options.chains, as_json=options.json)
