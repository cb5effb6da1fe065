"""Checks on how long messages take through several callbacks and nodes."""

from collections.abc import Callable, Sequence

from lessons.checks.check import Check, Verdict
from lessons.checks.reading import seconds
from sim.quantities.nanoseconds import nearest_ns
from sim.trace.figures.chains import Chain, ChainError, ChainRun, chain
from sim.trace.timeline import Timeline


def chain_never_takes_longer_than(names: Sequence[str], limit: float) -> Check:
    """From a message of the first topic to the first of the last one that comes of it: at most ``limit`` s.

    Topics or services between these may be named, too. Messages that lead to none do not count.

    Raises:
        ValueError: these are not two names or more.
    """
    return _within(names, limit, "takes", lambda found: found.whole_chain)


def chain_never_uses_older_than(names: Sequence[str], limit: float) -> Check:
    """Each message of the last topic comes of one of the first that was sent at most ``limit`` s before.

    Raises:
        ValueError: these are not two names or more.
    """
    return _within(names, limit, "uses a message", lambda found: found.runs)


def _within(
    names: Sequence[str], limit: float, what: str, counts: Callable[[Chain], Sequence[ChainRun]]
) -> Check:
    if isinstance(names, str) or len(names) < 2:
        raise ValueError(f"{names!r} is not a chain; give a first and a last topic: ('/scan', '/cmd_vel')")
    most = nearest_ns(limit)
    expected = f"at most {seconds(most)}"

    def judge(run: Timeline) -> Verdict:
        try:
            found = counts(chain(run, names))
        except ChainError as error:
            return Verdict(False, expected, str(error))
        slowest = max(found, key=lambda each: each.latency, default=None)
        if slowest is None:
            return Verdict(False, expected, "no message that went through")
        longest = max(slowest.steps, key=lambda step: step.length)
        seen = f"{seconds(slowest.latency, limit)}, of which {seconds(longest.length)}: {longest.words}"
        return Verdict(slowest.latency <= most, expected, seen, longest.start)

    return Check(f"{' to '.join(names)} never {what} too {'long' if what == 'takes' else 'old'}", judge)
