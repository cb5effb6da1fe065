"""The option that chooses a thread schedule by its seed."""

import argparse
from typing import TYPE_CHECKING

from cbtui.commands.options import values
from cbtui.commands.options.targets import refuse

if TYPE_CHECKING:
    from sim.clock.schedule import Seed


def add_seed(parser: argparse.ArgumentParser) -> None:
    """Add the option to a command."""
    parser.add_argument(
        "--seed",
        metavar="S",
        type=values.schedule,
        help="what decides which thread goes on where several can, and which gets a lock, on the virtual "
        "clock: 0, first come first served (0); a number, another order, each time the same; or what cbtui "
        "explore names, such as pct:5 or moves:3=1; random numbers stay the same",
    )


def check_seed(seed: "Seed | None", clock: str | None) -> None:
    """Refuse a seed on the real clock, where the machine chooses the order; ``clock`` is the chosen one."""
    if seed is not None and clock == "real":
        refuse(f"on the real clock the machine chooses the order of threads; leave out --seed {seed}")
