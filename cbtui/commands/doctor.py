"""``cbtui doctor``: looks whether this machine has what cbtui needs."""

import argparse
import os
import sys
from typing import TYPE_CHECKING

from cbtui.commands.options import appearance
from cbtui.text.output import say

if TYPE_CHECKING:
    from cbtui.doctor.verdict import Verdict


def add_options(parser: argparse.ArgumentParser) -> None:
    """Give the command its arguments."""
    appearance.add_options(parser)


def examine(options: argparse.Namespace) -> int:
    """Print a line for each thing looked at; returns the exit code: 0 nothing is wrong, 1 something is."""
    from cbtui.doctor import examinations
    from cbtui.doctor.verdict import Sign
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


def _print(verdict: "Verdict", *, plain: bool) -> None:
    sign = verdict.sign.plain if plain else verdict.sign.value
    remedy = f": {verdict.remedy}" if verdict.remedy else ""
    say(f"{sign} {verdict.subject:<12} {verdict.what}{remedy}\n")


def _sum(faults: int, notes: int) -> str:
    if faults:
        return f"{faults} thing{'s' * (faults > 1)} cbtui needs {'are' if faults > 1 else 'is'} not well."
    return "All is well." if not notes else "cbtui works here; with what is marked ! something is left out."
