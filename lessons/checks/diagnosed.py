"""Checks on findings of the diagnosis: nothing is stuck, and a rule finds no problem."""

from collections.abc import Callable

from lessons.checks.check import Check, Verdict
from sim.diagnosis import RULES, Finding, Weight, diagnose
from sim.trace.events import NoticeKind
from sim.trace.timeline import Timeline

STUCK = ("self-made-deadlock", "needs-one-more-worker", "endless-wait", "waits-for-lock")
"""Ids of the rules on callbacks that wait for ever; so does whatever is in a cycle of waits."""


def problems(run: Timeline) -> tuple[Finding, ...]:
    """Return the problems that the diagnosis finds in a run, without its remarks."""
    return tuple(each for each in diagnose(run) if each.weight_in(run) is Weight.PROBLEM)


def never_stuck() -> Check:
    """No callback waits for something that can never come, and no threads wait for each other's locks."""
    without = _without("nothing gets stuck", "no deadlock", lambda each: each.rule.id in STUCK or each.ring)

    def judge(run: Timeline) -> Verdict:
        for notice in run.notices:
            if notice.kind is NoticeKind.DEADLOCK:
                return Verdict(False, "no deadlock", notice.problem or notice.text, notice.t)
        return without.judge(run)

    return Check(without.asks, judge)


def gets_stuck() -> Check:
    """The opposite of ``never_stuck``: something waits for what can never come."""

    def judge(run: Timeline) -> Verdict:
        opposite = never_stuck().judge(run)
        seen = "none" if opposite.passed else opposite.seen
        return Verdict(not opposite.passed, "a deadlock", seen, opposite.at)

    return Check("something gets stuck", judge)


def no_problem(rule: str, asks: str = "") -> Check:
    """The diagnosis rule with an id finds no problem; ``asks`` says that in the lesson's words.

    Raises:
        ValueError: there is no such rule.
    """
    known = {each.id: each.summary for each in RULES}
    if rule not in known:
        raise ValueError(f"no rule is called {rule!r}; there are {', '.join(known)}")
    return _without(asks or f"never: {known[rule]}", "no such problem", lambda found: found.rule.id == rule)


def no_problems() -> Check:
    """The diagnosis finds no problem at all."""
    return _without("the diagnosis finds no problem", "no problem", lambda _: True)


def _without(asks: str, expected: str, counts: Callable[[Finding], object]) -> Check:
    def judge(run: Timeline) -> Verdict:
        for found in problems(run):
            if counts(found):
                return Verdict(False, expected, found.explained(run).what, found.known_at)
        return Verdict(True, expected, "none")

    return Check(asks, judge)
