"""The findings of all rules in a run, updated incrementally during the run."""

from collections.abc import Collection, Iterable, Iterator
from dataclasses import replace
from typing import TypeAlias

from sim.diagnosis.rule import Finding, Rule, Weight, fault_of
from sim.diagnosis.rules import RULES
from sim.diagnosis.rules.incomplete import FAILED_RULES
from sim.diagnosis.timeline_view import TimelineView
from sim.quantities.nanoseconds import SECOND
from sim.trace.events import EntityId
from sim.trace.figures.concurrency import Concurrency
from sim.trace.model import Nanoseconds, Window
from sim.trace.timeline import Timeline

_OUT_OF_ORDER: Nanoseconds = SECOND
"""How far threads of a real-clock run may report out of order; younger events are checked again."""

_BEFORE_START: Nanoseconds = -1

_Occurrences: TypeAlias = dict[tuple[tuple[str, EntityId, str], EntityId], Finding]
"""The occurrences of a finding that have one subject, as one, by its key and the subject."""


class Diagnoses:
    """The findings of a run, one for each rule, subject and topic or service.

    ``update`` checks new and unfinished events, and the last one or two seconds again: findings there are
    dropped if they no longer hold. Not thread-safe, like the timeline.
    """

    def __init__(self, rules: Iterable[Rule] = RULES) -> None:
        self.findings: tuple[Finding, ...] = ()
        """The findings of the last update: problems, the worst first, then remarks, the earliest first."""
        self._rules = (*rules, FAILED_RULES)
        self._timeline: Timeline | None = None
        self._from = _BEFORE_START
        self._settled: _Occurrences = {}

    def update(self, timeline: Timeline) -> tuple[Finding, ...]:
        """Check what is new in a timeline since the last update; with another timeline, start over."""
        if timeline is not self._timeline:
            self._start_over(timeline)
        window = Window(self._from, timeline.end + 1)
        view = TimelineView(timeline, window, self._concurrency)
        self._from = max(self._from, (timeline.end - _OUT_OF_ORDER) // SECOND * SECOND)
        merged = dict(self._settled)
        for rule in self._rules:
            for found in _checked(rule, view):
                if found.until > window.start:
                    _merge(merged, found)
                    if found.until <= self._from:
                        _merge(self._settled, found)
        self.findings = self._ordered(_worst_of_each_key(merged.values(), timeline), timeline)
        return self.findings

    def _start_over(self, timeline: Timeline) -> None:
        self._timeline = timeline
        self._concurrency = Concurrency(timeline)
        self._from = timeline.begun + _BEFORE_START
        self._settled = {}

    def _ordered(self, found: Collection[Finding], timeline: Timeline) -> tuple[Finding, ...]:
        """Return the relevant findings: problems, the worst first, then remarks, the earliest first."""
        lasting = [each for each in found if each.until >= timeline.end and each.stuck]
        hiding = [each for each in found if each.rule.hides]
        left = [
            each
            for each in found
            if not _is_hidden(each, hiding) and not (each.rule.is_effect and _is_due_to(lasting, each))
        ]
        causes = {each.culprit for each in left if each.rule.by_culprit}
        parted = [each if each.due_to in causes else replace(each, due_to=0) for each in left]
        weights = {each.key: each.relevance(timeline) for each in parted}

        def rank(each: Finding) -> tuple[bool, Nanoseconds, object]:
            is_remark = weights[each.key] is Weight.REMARK
            when = (each.at or timeline.end) if is_remark else 0  # those on the whole run come last
            return is_remark, when, self._rank(each)

        return tuple(sorted((each for each in parted if weights[each.key] is not None), key=rank))

    def _rank(self, found: Finding) -> tuple[int, Nanoseconds, EntityId, str, EntityId]:
        return self._rules.index(found.rule), found.at, found.subject, found.about, found.culprit


def _checked(rule: Rule, view: TimelineView) -> Iterator[Finding]:
    """Yield what a rule finds; if it fails, that too."""
    try:
        yield from rule.check(view)
    except Exception as error:  # noqa: BLE001 - a fault of one rule, told as a finding
        yield FAILED_RULES.failed(rule, fault_of(rule, error), view.timeline)


def _is_hidden(found: Finding, hiding: Iterable[Finding]) -> bool:
    """Return whether another finding has a rule that hides this one, on the same culprit if both have one."""
    return any(
        found.rule.id in each.rule.hides
        and (not each.culprit or found.culprit in (0, each.culprit) or found.due_to == each.culprit)
        for each in hiding
    )


def _is_due_to(lasting: Iterable[Finding], found: Finding) -> bool:
    """Return whether a finding is an effect of callbacks that can never continue, as other findings say.

    A finding on the whole run may be such an effect.
    """
    stuck = frozenset[EntityId]().union(*(each.stuck for each in lasting if each is not found))
    return bool(stuck) and (not found.at or found.culprit in stuck or found.subject in stuck)


def diagnose(timeline: Timeline) -> tuple[Finding, ...]:
    """Return what the rules find in a whole timeline."""
    return Diagnoses().update(timeline)


def _worst_of_each_key(found: Iterable[Finding], timeline: Timeline) -> Collection[Finding]:
    """Return of findings that differ in their subject only the worst, a relevant one if there is one."""
    worst: dict[tuple[str, EntityId, str], Finding] = {}

    def rank(each: Finding) -> tuple[bool, int, Nanoseconds]:
        return each.relevance(timeline) is not None, each.size, -each.at

    for each in found:
        known = worst.get(each.key)
        if known is None or rank(each) > rank(known):
            worst[each.key] = each
    return worst.values()


def _merge(into: _Occurrences, found: Finding) -> None:
    """Add an occurrence: the worst one gives the times, of equal ones the earliest.

    A rule may date all by the first one.
    """
    key = found.key, found.subject
    known = into.get(key)
    if known is None:
        into[key] = found
        return
    worst = found if (found.size, -found.at) > (known.size, -known.at) else known
    at = min(known.at, found.at) if found.rule.dated_by_first else worst.at
    into[key] = replace(worst, at=at, count=known.count + found.count)
