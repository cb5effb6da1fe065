"""Results of an exploration as plain text for a terminal."""

import shlex
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from textwrap import fill
from typing import NamedTuple

import msgspec

from cbtui.runs.judged.check_text import FAILED, PASSED
from cbtui.runs.judged.exploring import ScheduleResult, SeedT
from sim.clock.schedule import Seed
from sim.diagnosis.text import WIDTH
from sim.quantities.plural import counted


class ReplayCommand(msgspec.Struct, frozen=True):
    """A command line that runs a schedule again; ``arguments`` are the program's own, behind ``--``."""

    words: tuple[str, ...]
    arguments: tuple[str, ...] = ()

    def with_seed(self, seed: Seed) -> str:
        """Return the line for a shell that runs the schedule of a seed."""
        behind = ("--", *self.arguments) if self.arguments else ()
        return shlex.join([*self.words, "--seed", str(seed), *behind])


class Shrunk(NamedTuple):
    """The outcome of a search for a simple schedule that fails; ``result`` is None if it found none."""

    tried: int
    seed: str
    result: ScheduleResult | None
    preempted: int = 0

    @property
    def rank(self) -> tuple[bool, int, int, int]:
        """Of two outcomes, the simpler schedule has the lower one."""
        return self.result is None, self.preempted, self.seed.count("="), len(self.seed)


def exploration_text(
    name: str,
    found: Mapping[SeedT, ScheduleResult],
    replays: Sequence[ReplayCommand],
    proof: str = "",
    shrunk: Shrunk | None = None,
) -> str:
    """Summarise the different outcomes of a program's schedules, each with an example seed.

    ``found`` has the result of each seed, the simplest first. ``replays`` are the commands that repeat a
    schedule. ``proof`` says what was searched, "" for nothing in particular. ``shrunk`` is the outcome of the
    search for a simpler schedule, None if there was no search.
    """
    return "\n".join([*_lines(name, found, replays, proof, shrunk), ""])


def proof_text(found: Mapping[str, ScheduleResult], preemptions: int, *, is_complete: bool) -> str:
    """Say what a search within a bound has shown, and whether it came to its end."""
    at_most = f"with at most {counted(preemptions, 'preemption')}"
    bound = at_most if preemptions else "without preemptions"
    said = (
        bound if any(not each.well for each in found.values()) else f"no deadlock and no failed check {bound}"
    )
    ran = (
        f"{counted(len(found), 'schedule')}, all run"
        if is_complete
        else f"stopped after {len(found)} schedules"
    )
    return f"{said}: {ran}"


def _lines(
    name: str,
    found: Mapping[SeedT, ScheduleResult],
    replays: Sequence[ReplayCommand],
    proof: str,
    shrunk: Shrunk | None,
) -> Iterator[str]:
    outcomes: defaultdict[ScheduleResult, list[SeedT]] = defaultdict(list)
    for seed, result in found.items():
        outcomes[result].append(seed)
    failed = sum(len(seeds) for result, seeds in outcomes.items() if not result.well)
    said = f"{counted(failed, 'schedule')} failed" if failed else "none failed"
    if proof:
        yield f"{name}: {proof}"
    yield f"{name}: {counted(len(found), 'schedule')}, {counted(len(outcomes), 'outcome')}, {said}"
    # Failures first, and the more frequent first.
    for result, seeds in sorted(outcomes.items(), key=lambda pair: (pair[0].well, -len(pair[1]))):
        yield ""
        sign = PASSED if result.well else FAILED
        such = "all of them" if len(seeds) == len(found) else counted(len(seeds), "schedule")
        yield f"{sign} {such}, such as seed {seeds[0]}"
        yield from _result(result, found[seeds[0]])
    yield ""
    if not all(result.repeatable for result in found.values()):
        yield "This program is not repeatable: a seed orders its threads, and another run of it may differ."
    shown: Seed = next((seed for seed, result in found.items() if not result.well), next(iter(found)))
    if shrunk is not None:
        yield from _simplest(shrunk)
        shown = shrunk.seed or shown
    yield "To see one again:"
    for command in replays:
        yield f"  {command.with_seed(shown)}"


def _simplest(shrunk: Shrunk) -> Iterator[str]:
    if shrunk.result is None:
        yield f"No simpler order that fails was found in {counted(shrunk.tried, 'further schedule')}."
    else:
        yield _wrapped(f"The simplest order found, run to prove it: seed {shrunk.seed}", 0)
        yield from (_wrapped(failure.what, 4) for failure in shrunk.result.failures)
        yield from _steps(shrunk.result)
    yield ""


def _result(result: ScheduleResult, shown: ScheduleResult) -> Iterator[str]:
    for failure in shown.failures:
        yield _wrapped(failure.what, 4)
        if failure.detail:
            yield _wrapped(failure.detail, 6)
    if shown.failures:
        yield from _steps(shown)
    for note in shown.notes:
        yield _wrapped(f"note: {note}", 4)
    for problem in shown.told or result.problems:
        yield _wrapped(f"diagnosis: {problem}", 4)
    if result.well and not result.problems:
        yield "    no problem"


def _steps(shown: ScheduleResult) -> Iterator[str]:
    """Where a schedule leaves the usual order, and the accesses that conflict in it."""
    for number, step in enumerate(shown.steps, start=1):
        yield _wrapped(f"{number}. {step}", 6)
    for conflict in shown.conflicts:
        yield _wrapped(f"conflict: {conflict}", 4)


def _wrapped(text: str, indent: int) -> str:
    return fill(
        " ".join(text.split()),
        WIDTH,
        initial_indent=" " * indent,
        subsequent_indent=" " * (indent + 2),
        break_long_words=False,
        break_on_hyphens=False,
    )
