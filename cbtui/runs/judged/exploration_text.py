"""Results of an exploration as plain text for a terminal."""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from textwrap import fill

from cbtui.runs.judged.check_text import FAILED, PASSED
from cbtui.runs.judged.exploring import ScheduleResult
from sim.diagnosis.text import WIDTH
from sim.plural import counted


def exploration_text(name: str, found: Mapping[int, ScheduleResult], replays: Sequence[str]) -> str:
    """Summarise the different outcomes of a program's schedules, each with an example seed.

    ``found`` has the result of each seed, ``replays`` the commands that repeat a schedule, without its seed.
    """
    return "\n".join([*_lines(name, found, replays), ""])


def _lines(name: str, found: Mapping[int, ScheduleResult], replays: Sequence[str]) -> Iterator[str]:
    outcomes: defaultdict[ScheduleResult, list[int]] = defaultdict(list)
    for seed, result in found.items():
        outcomes[result].append(seed)
    failed = sum(len(seeds) for result, seeds in outcomes.items() if not result.well)
    said = f"{counted(failed, 'schedule')} failed" if failed else "all went well"
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
    shown = next((seed for seed, result in found.items() if not result.well), min(found))
    yield "To see one again:"
    for command in replays:
        yield f"  {_with_seed(command, shown)}"


def _result(result: ScheduleResult, shown: ScheduleResult) -> Iterator[str]:
    for failure in shown.failures:
        yield _wrapped(failure.what, 4)
        if failure.detail:
            yield _wrapped(failure.detail, 6)
    for note in shown.notes:
        yield _wrapped(f"note: {note}", 4)
    if result.problems:
        yield _wrapped(f"diagnosis: {', '.join(result.problems)}", 4)
    elif result.well:
        yield "    no problem"


def _wrapped(text: str, indent: int) -> str:
    return fill(
        " ".join(text.split()),
        WIDTH,
        initial_indent=" " * indent,
        subsequent_indent=" " * (indent + 2),
        break_long_words=False,
        break_on_hyphens=False,
    )


def _with_seed(command: str, seed: int) -> str:
    """The command with the seed inserted before the program's own arguments."""
    own, dashes, behind = command.partition(" -- ")
    return f"{own} --seed {seed}{dashes}{behind}"
