"""Finds the smallest system that still differs."""

from itertools import islice

from tests.conformance.comparing import Result, compared, decided
from tests.conformance.searching import searched


def shrunk(result: Result, python: str, distro: str, at_once: int, repeats: int, runs: int) -> Result:
    """The smallest system that still differs as one does, with one thing less at a time."""
    smallest = result
    while (less := _smaller(smallest, python, distro, at_once, repeats, runs)) is not None:
        smallest = less
    return smallest


def _smaller(
    result: Result, python: str, distro: str, at_once: int, repeats: int, runs: int
) -> Result | None:
    name = result.case.seed
    candidates = result.case.system.smaller()
    while systems := list(islice(candidates, 2 * at_once)):
        given = decided(((name, system) for system in systems), distro, result.case.pace, fewest_lines=1)
        for each in searched(compared(given, python, distro, at_once, repeats), distro, runs):
            if each.outcome is result.outcome:
                return each
    return None
