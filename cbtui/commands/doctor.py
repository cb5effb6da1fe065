"""``cbtui doctor``: checks whether this machine has what cbtui needs."""

import argparse
import os
import sys
from typing import TYPE_CHECKING

from cbtui.commands.options import appearance, more_lessons
from cbtui.text.output import say
from sim.quantities.plural import counted

if TYPE_CHECKING:
    from cbtui.doctor.examination import Examination


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    appearance.add_options(parser)
    more_lessons.add_option(parser)


def examine(options: argparse.Namespace) -> int:
    """Print a line for each check; returns the exit code: 0 if nothing is wrong, else 1."""
    from cbtui.doctor import examinations
    from cbtui.doctor.examination import Sign
    from cbtui.terminal.capabilities import charset_of

    charset = options.charset
    if charset in {None, "auto"}:
        charset = charset_of(os.environ, bool(sys.flags.utf8_mode), sys.stdout.encoding or "utf-8")
    faults = notes = 0
    for verdict in examinations(charset, options.config):
        faults += verdict.sign is Sign.FAULT
        notes += verdict.sign is Sign.NOTE
        _print(verdict, plain=charset == "ascii")
    say(f"\n{_sum(faults, notes)}\n")
    return 1 if faults else 0


def _print(verdict: "Examination", *, plain: bool) -> None:
    sign = verdict.sign.plain if plain else verdict.sign.value
    remedy = f": {verdict.remedy}" if verdict.remedy else ""
    say(f"{sign} {verdict.subject:<12} {verdict.what}{remedy}\n")


def _sum(faults: int, notes: int) -> str:
    if faults:
        return f"{counted(faults, 'thing')} cbtui needs {'are' if faults > 1 else 'is'} not well."
    return (
        "All is well." if not notes else "cbtui works here; where a line is marked !, something is left out."
    )
