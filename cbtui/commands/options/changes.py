"""The options that change a program's set-up without touching its file, and what they come to."""

import argparse
from dataclasses import replace
from typing import TYPE_CHECKING

from cbtui.commands.options import values

if TYPE_CHECKING:
    from cbtui.runs.setup.changes import Changes, Place


def add_options(parser: argparse.ArgumentParser) -> None:
    """Give a command the options."""
    parser.add_argument(
        "--threads",
        metavar="N",
        type=values.threads,
        help="number of threads of the executor, instead of its own",
    )
    parser.add_argument(
        "--group",
        dest="groups",
        metavar="CALLBACK=GROUP",
        type=values.group_change,
        action="append",
        default=[],
        help="put a callback into another group: own, shared, reentrant or default; NODE:CALLBACK means one "
        "node's; may be given again",
    )
    parser.add_argument(
        "--period",
        dest="periods",
        metavar="CALLBACK=SECONDS",
        type=values.period_change,
        action="append",
        default=[],
        help="give the timer that calls CALLBACK another period; may be given again",
    )
    parser.add_argument(
        "--sensor-rate",
        metavar="HZ",
        type=values.sensor_rate,
        help="how often a second the robot's sensors measure (20)",
    )


def add_traceback(parser: argparse.ArgumentParser) -> None:
    """Give a command that shows what a program prints the option on its tracebacks."""
    parser.add_argument(
        "--traceback",
        action="store_true",
        help="print tracebacks whole: with the frames of cbtui's model of rclpy",
    )


def changes_of(options: argparse.Namespace) -> "Changes":
    """What the options change."""
    from cbtui.runs.setup.changes import Changes

    return Changes(
        options.threads, dict(options.groups), dict(options.periods), sensor_rate=options.sensor_rate
    )


def seeded_changes_of(options: argparse.Namespace) -> "Changes":
    """What the options change, the order of threads that ``--seed`` chooses, and ``--traceback``."""
    return replace(changes_of(options), seed=options.seed, whole_tracebacks=options.traceback)


def words(changes: "Changes") -> list[str]:
    """The options as they stand on a command line, without a seed."""
    said = [] if changes.threads is None else ["--threads", str(changes.threads)]
    for place, wish in changes.groups.items():
        said += ["--group", f"{_spelt(place)}={wish}"]
    for place, period in changes.periods.items():
        said += ["--period", f"{_spelt(place)}={period / 1e9:.9g}"]
    return said if changes.sensor_rate is None else [*said, "--sensor-rate", f"{changes.sensor_rate:g}"]


def _spelt(place: "Place") -> str:
    node, callback = place
    return f"{node}:{callback}" if node else callback
