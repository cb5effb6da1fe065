"""The options that give a run timed inputs: service calls, ``ros2`` lines and keys."""

import argparse
from collections.abc import Iterable
from operator import itemgetter

from cbtui.commands.options import values
from cbtui.commands.options.targets import refuse


def add_length(parser: argparse.ArgumentParser, shown: str) -> None:
    """Add ``--for`` to a command; ``shown`` is its help."""
    parser.add_argument("--for", dest="seconds", metavar="SECONDS", type=values.duration, help=shown)


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add ``--call`` and ``--at`` to a command."""
    parser.add_argument(
        "--call",
        dest="calls",
        metavar="SECONDS",
        type=values.moment,
        action="append",
        default=[],
        help="call the SetBool service at that time of what is run; may be given again",
    )
    parser.add_argument(
        "--at",
        dest="lines",
        metavar=("SECONDS", "LINE"),
        nargs=2,
        action=values.TimedLineOption,
        default=[],
        help="run a ros2 line at that time, such as 2 'ros2 topic list'; may be given again",
    )


def add_typing(parser: argparse.ArgumentParser) -> None:
    """Add ``--type`` to a command."""
    parser.add_argument(
        "--type",
        dest="typed",
        metavar=("SECONDS", "TEXT"),
        nargs=2,
        action=values.TimedKeysOption,
        default=[],
        help=r"type that text at that time, for a program that reads from the keyboard, such as 2 w or "
        r"3 '0.5\n'; may be given again (else: what is typed here, or comes through a pipe)",
    )


def check(options: argparse.Namespace, seconds: float) -> None:
    """Refuse inputs that come after a run's end, in seconds."""
    if sentence := late(seconds, options.calls, options.lines, getattr(options, "typed", ())):
        refuse(f"{sentence}; see --for")


def late(
    seconds: float,
    calls: Iterable[float],
    lines: Iterable[tuple[float, str]],
    typed: Iterable[tuple[float, str]] = (),
) -> str | None:
    """Return a sentence on the first input after a run's end, None if there is none."""
    moments = [("call", at) for at in calls] + [("line", at) for at, _ in lines]
    moments += [("key", at) for at, _ in typed]
    for what, at in moments:
        if at >= seconds:
            return f"a {what} at {at:g} s comes when the run of {seconds:g} s is over"
    return None


def words(calls: Iterable[float], lines: Iterable[tuple[float, str]]) -> list[str]:
    """Return the inputs as words of a command line, in the order of time."""
    return [
        *(word for at in sorted(calls) for word in ("--call", f"{at:.12g}")),
        *(word for at, line in sorted(lines, key=itemgetter(0)) for word in ("--at", f"{at:.12g}", line)),
    ]
