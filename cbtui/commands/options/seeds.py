"""The option that chooses an order of threads, and what goes with it."""

import argparse

from cbtui.commands.options import values
from cbtui.commands.options.targets import refuse


def add_seed(parser: argparse.ArgumentParser) -> None:
    """Give a command the option."""
    parser.add_argument(
        "--seed",
        metavar="S",
        type=values.seed,
        help="run in the order of threads that cbtui explore calls S; on the virtual clock",
    )


def check_seed(seed: int | None, clock: str | None) -> None:
    """Refuse a seed where the machine alone chooses the order; ``clock`` is the one that was asked for."""
    if seed is not None and clock == "real":
        refuse(f"on the real clock the machine chooses the order of threads; leave out --seed {seed}")
