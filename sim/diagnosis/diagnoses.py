"""What all rules found in a run so far, kept up to date without looking at everything again."""

from collections.abc import Iterable
from dataclasses import replace
from typing import TypeAlias

from sim.diagnosis.rule import Finding, Rule, Weight
from sim.diagnosis.rules import RULES
from sim.diagnosis.timeline_view import TimelineView
from sim.trace.events import EntityId
from sim.trace.figures.concurrency import Concurrency
from sim.trace.model import Nanoseconds, Window
from sim.trace.timeline import Timeline
from sim.units import SECOND

_LATE: Nanoseconds = SECOND
"""How long threads of a real-clock run may report out of order; what is younger is looked at again."""

_BEFORE_ALL: Nanoseconds = -1

_Key: TypeAlias = tuple[str, EntityId, str]


class Diagnoses:
    """The findings of a run, one for each rule, subject and topic or service, problems first.

    ``update`` looks at what is new, at what lasts still and at the last second or two again: what was found
    there is forgotten if it no longer holds. Not thread-safe, as the timeline.
    """

    def __init__(self, rules: Iterable[Rule] = RULES) -> None:
        self.findings: tuple[Finding, ...] = ()
        """What was found until the last update."""
        self._rules = tuple(rules)
        self._timeline: Timeline | None = None
        self._from = _BEFORE_ALL
        self._settled: dict[_Key, Finding] = {}

    def update(self, timeline: Timeline) -> tuple[Finding, ...]:
        """TimelineView at what a timeline has learnt since the last update; another timeline begins anew."""
        if timeline is not self._timeline:
            self._begin(timeline)
        window = Window(self._from, timeline.end + 1)
        look = TimelineView(timeline, window, self._concurrency)
        self._from = max(self._from, (timeline.end - _LATE) // SECOND * SECOND)
        merged = dict(self._settled)
        for rule in self._rules:
            for found in rule.check(look):
                if found.until > window.start:
                    _merge(merged, found)
                    if found.until <= self._from:
                        _merge(self._settled, found)
        self.findings = self._told(merged.values(), timeline)
        return self.findings

    def _begin(self, timeline: Timeline) -> None:
        self._timeline = timeline
        self._concurrency = Concurrency(timeline)
        self._from = _BEFORE_ALL
        self._settled = {}

    def _told(self, found: Iterable[Finding], timeline: Timeline) -> tuple[Finding, ...]:
        """Those that matter: problems before remarks, then by rule, the earliest first."""
        weighed = [(each.rule.weigh(each, timeline), each) for each in found]
        telling = [(weight, each) for weight, each in weighed if weight is not None]
        telling.sort(key=lambda pair: (pair[0] is Weight.REMARK, *self._place(pair[1])))
        return tuple(each for _, each in telling)

    def _place(self, found: Finding) -> tuple[int, Nanoseconds, EntityId, str]:
        return self._rules.index(found.rule), found.at, found.subject, found.about


def diagnose(timeline: Timeline) -> tuple[Finding, ...]:
    """Return what the rules find in all that a timeline knows."""
    return Diagnoses().update(timeline)


def _merge(into: dict[_Key, Finding], found: Finding) -> None:
    """Take in an occurrence: the worst gives the times, of equal ones the earliest."""
    key = (found.rule.id, found.subject, found.about)
    known = into.get(key)
    if known is None:
        into[key] = found
        return
    worst = found if (found.size, -found.at) > (known.size, -known.at) else known
    into[key] = replace(worst, count=known.count + found.count)
