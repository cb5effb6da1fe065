"""The options that change a program's set-up without touching its file, and what they come to."""

import argparse
from typing import TYPE_CHECKING

from cbtui.commands import values
from cbtui.commands.seeds import add_seed

if TYPE_CHECKING:
    from cbtui.changes import Changes


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
    add_seed(parser)


def changes_of(options: argparse.Namespace) -> "Changes":
    """What the options change."""
    from cbtui.changes import Changes

    return Changes(
        options.threads,
        dict(options.groups),
        dict(options.periods),
        sensor_rate=options.sensor_rate,
        seed=options.seed,
    )
