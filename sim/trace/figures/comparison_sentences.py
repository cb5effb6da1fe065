"""The sentences about a comparison: which run is better and by what, how one ended, and what is compared."""

import math
from collections.abc import Callable, Iterator, Sequence
from itertools import groupby
from typing import NamedTuple

from sim.trace.events import EntityId
from sim.trace.figures.comparison import CallbackInRun, Comparison, RunFigures
from sim.trace.figures.comparison_rows import RUNS
from sim.trace.figures.comparison_wording import (
    AGES,
    ERRORS,
    FLAWS,
    LATENESS,
    LOSSES,
    WAITS,
    Wording,
    in_seconds,
    stretch,
)
from sim.trace.figures.statistics import Distribution
from sim.trace.model import Nanoseconds, Window


class Problems(NamedTuple):
    """What the diagnoses of both runs tell.

    ``told`` are sentences. ``speaks`` is whether what is gone in the second run (> 0) or what is new there
    (< 0) weighs more; None if nothing is either. ``stuck``: something waits for ever in both runs.
    """

    told: str = ""
    speaks: int | None = None
    stuck: bool = False


NO_PROBLEMS = Problems()


def is_tie(comparison: Comparison, problems: Problems = NO_PROBLEMS) -> bool:
    """Whether neither run is better, though both were given the same commands, and nothing is gone or new."""
    return not (
        comparison.unlike_commands
        or comparison.shares_little
        or problems.stuck
        or problems.speaks is not None
        or any(_differences(comparison, problems))
    )


def ended_early(comparison: Comparison, *ends: Nanoseconds) -> str:
    """Return which run an exception ended while the other one goes on, if only to one of its own; or "".

    Of such runs only the part before the exception can be compared, which speaks for no run. ``ends`` are how
    far both have come by now, if they went on since.
    """
    runs = comparison.first, comparison.second
    ends = ends or (runs[0].end, runs[1].end)
    for place, run in enumerate(runs):
        other = runs[1 - place]
        is_shorter = run.end <= comparison.window.end and in_seconds(run.end) != in_seconds(ends[1 - place])
        if run.crashes and not other.crashes and is_shorter:
            told = f"{RUNS[place]} ended at {in_seconds(run.end)} s with an exception"
            beside = f"; {RUNS[1 - place]} has none up to {in_seconds(ends[1 - place])} s"
            if other.fails:
                beside = f", and {RUNS[1 - place]} at {in_seconds(other.end)} s with one"
            return capitalised(told + beside)
    return ""


def capitalised(words: str) -> str:
    """Return words with a capital at the beginning of the sentence."""
    return words[:1].upper() + words[1:]


def headline(comparison: Comparison, problems: Problems) -> str:
    """Return the sentences on both runs: what the diagnoses tell, and the verdict."""
    early = "" if comparison.shares_little else ended_early(comparison)
    judged = capitalised(early or verdict(comparison, problems))
    return f"{problems.told} {judged}.".lstrip()


def verdict(comparison: Comparison, problems: Problems = NO_PROBLEMS) -> str:
    """Return which run is better and by what, in one sentence that also names what is worse.

    Errors weigh most, then subscriptions that do not match, losses, collisions, waits, lateness, and the age
    of data; problems that are gone or new in the second run weigh more than all of them. Of runs that were
    not given the same commands, as calls of a service, or that share few callbacks, it says that.
    """
    if comparison.shares_little:
        shared = f"only {' and '.join(comparison.shared)}" if comparison.shared else "none"
        of = f"the runs share {shared} of {len(comparison.callbacks)} callbacks"
        return f"{of}: too little in common for one to be better"
    if comparison.unlike_commands:
        text, one, other = comparison.unlike_commands[0]
        given = f"{RUNS[0]} has {one or 'no'} '{text}', {RUNS[1]} has {other or 'none'}"
        same = "; cbtui compare --call SECONDS gives both the same" if text.startswith("call ") else ""
        return f"{given}: only with as many in both can one be better{same}"
    better: list[_FigureDifference] = []
    worse: list[_FigureDifference] = []
    for each in _differences(comparison, problems):
        (better if each.second < each.first else worse).append(each)
    if not (better or worse or problems.speaks):
        return _tie(comparison, problems)
    is_better = min(map(_weight, better), default=_NONE) <= min(map(_weight, worse), default=_NONE)
    by_figures = bool(better or worse) and (not problems.speaks or is_better == (problems.speaks > 0))
    if not by_figures:
        is_better = bool(problems.speaks and problems.speaks > 0)
    for_it, against = (better, worse) if is_better else (worse, better)
    told = f"{RUNS[1]} is {'better' if is_better else 'worse'}"
    if by_figures:
        told += f": {_listed(for_it)}"
    else:
        told += f" by what is {'gone' if is_better else 'new'}"
        told += f", and by {_listed(for_it)}" if for_it else ""
    return told + (f"; but {_listed(against)}" if against else "")


def _tie(comparison: Comparison, problems: Problems) -> str:
    if problems.stuck:
        return "Neither run is better: both are stuck"
    if problems.speaks is not None:
        return "Neither run is better by its figures"
    waiting = [pair.name for pair in comparison.callbacks if pair.lasts]
    if waiting:
        named = " and ".join(waiting[:_NAMED])
        return f"Neither run is better: in both {named} still {'wait' if waiting[1:] else 'waits'}"
    unlike = [pair for pair in comparison.callbacks if pair.is_unlike]
    if unlike:
        most = max(unlike, key=lambda pair: max(pair.calls))
        calls = f"calls of {most.name} {most.calls[1]} instead of {most.calls[0]}"
        return f"Neither run is better by errors, losses or waits; but {calls}"
    if comparison.is_real:
        return "Both runs are about the same: what differs may be the real clock's doing"
    return "Neither run is better: no callback fails, loses or waits more in one of them"


def notable(
    comparison: Comparison, problems: Problems = NO_PROBLEMS
) -> tuple[dict[EntityId, int], dict[EntityId, int]]:
    """Return the callbacks of each run that differ notably, with their ranks: 0 decides the verdict.

    Then come those whose calls take longer in one run, which may be why others wait. Last are those that wait
    long in one of the runs, or run much less often, if at all.
    """
    deciding = dict.fromkeys(each.name for each in sorted(_differences(comparison, problems), key=_weight))
    ranks = {name: place for place, name in enumerate(deciding)}
    pairs = [
        each
        for each in comparison.callbacks
        if each.name in ranks or each.takes_unlike or each.is_unlike or each.waits
    ]
    pairs.sort(key=lambda pair: (ranks.get(pair.name, len(ranks)), not pair.takes_unlike))
    return (
        {pair.first.figures.entity.id: rank for rank, pair in enumerate(pairs) if pair.first},
        {pair.second.figures.entity.id: rank for rank, pair in enumerate(pairs) if pair.second},
    )


class _FigureDifference(NamedTuple):
    """A figure, of which less is better, that differs enough to speak for a run; ``rank`` 0 weighs most.

    ``name`` is the callback's; "" for a figure of the whole run.
    """

    rank: int
    what: str
    name: str
    first: float
    second: float
    wording: Wording

    @property
    def text(self) -> str:
        """Both figures in words."""
        first, second = self.wording.format(self.first), self.wording.format(self.second)
        of = f" of {self.name}" if self.name else ""
        return f"{self.what}{of} {second} instead of {first}"


def _weight(difference: _FigureDifference) -> tuple[float, float]:
    return difference.rank, -abs(difference.second - difference.first)


_NAMED = 2
"""Of more, the number is told and not the names."""


def _listed(differences: Sequence[_FigureDifference]) -> str:
    """The first difference with its figures, and what else differs; a wait is not told again as an age."""
    first, *others = sorted(differences, key=_weight)
    waiting = {each.name for each in differences if each.wording is WAITS}
    others = [each for each in others if each.wording not in _OF_CALLS or each.name not in waiting]
    if len(others) > _NAMED:
        return f"{first.text}, and in {len(others)} more ways"
    also = [
        _also(what, " and ".join(each.name for each in alike), first)
        for what, alike in groupby(others, key=lambda each: each.what)
    ]
    return ", also ".join(filter(None, (first.text, " and ".join(also))))


def _also(what: str, names: str, first: _FigureDifference) -> str:
    if not names:
        return what
    return f"of {names}" if what == first.what else f"{what} of {names}"


def _differences(comparison: Comparison, problems: Problems) -> Iterator[_FigureDifference]:
    pairs = [(pair.name, pair.first, pair.second) for pair in comparison.callbacks]
    for rank, what, figure, wording, least in _DECIDING:
        for name, first, second in pairs:
            if first is not None and second is not None:
                one, other = figure(first), figure(second)
                lower, higher = (first, second) if one < other else (second, first)
                lasts = (any if problems.stuck else all)((first.lasts, second.lasts))
                if lasts and wording in _OF_WAITS:
                    continue  # it only tells how long this run has been stuck
                if wording.on(is_real=comparison.is_real).is_noise(one, other):
                    continue
                is_like = 2 * lower.figures.calls >= higher.figures.calls
                if (is_like or wording not in _OF_CALLS) and abs(other - one) >= least:
                    weight = rank if is_like or what != _LOST else _LEAST
                    yield _FigureDifference(weight, what, name, one, other, wording)
    for rank, what, count in _DECIDING_RUNS:
        one, other = count(comparison.first), count(comparison.second)
        if one != other:
            yield _FigureDifference(rank, what, "", one, other, FLAWS)


_NONE = (math.inf, 0.0)
_LEAST = 6
"""The rank of what weighs less than all else."""
_DECIDING_RUNS: tuple[tuple[int, str, Callable[[RunFigures], int]], ...] = (
    (0, "runs that an error ends", lambda run: run.crashes),
    (1, "subscriptions that do not match a publisher", lambda run: run.mismatches),
    (2, "collisions", lambda run: run.collisions),
)
_OF_CALLS = (LATENESS, AGES)
"""Figures of calls: lower ones of far fewer calls, as of a callback that hangs, speak for no run."""
_OF_WAITS = (WAITS, *_OF_CALLS)
_LOST = "losses"
"""Fewer in far fewer calls weigh least: who hangs sends nothing that could be lost."""
_NOTABLE = 10_000_000
"""Nanoseconds by which a wait or an age must differ."""


def _most(values: Distribution | None) -> float:
    return 0.0 if values is None else values.most


_DECIDING: tuple[tuple[int, str, Callable[[CallbackInRun], float], Wording, float], ...] = (
    (0, "errors", lambda side: side.figures.errors, ERRORS, 1),
    (2, _LOST, lambda side: side.figures.drops or 0, LOSSES, 1),
    (3, "longest wait", lambda side: side.longest_wait, WAITS, _NOTABLE),
    (4, "worst lateness", lambda side: _most(side.figures.late), LATENESS, _NOTABLE),
    (5, "oldest data", lambda side: _most(side.figures.age), AGES, _NOTABLE),
)
"""Figures that decide a verdict, each with its rank, and by how much it must differ."""


def extent(window: Window, *ends: Nanoseconds, is_real: bool = False) -> str:
    """The compared part of runs with these ends: ``0 to 12.4 s; run A is 20 s long``."""
    parts = [stretch(window)]
    if is_real and not window.start:
        parts.append("each from its first call on")
    for name, end in zip(RUNS, ends, strict=True):
        if end > window.end and in_seconds(end) != in_seconds(window.end):
            parts.append(f"{name} is {in_seconds(end)} s long")
    return "; ".join(parts)
