"""Findings are kept up to date by looking at what is new, and come to the same as looking at everything."""

from collections.abc import Iterator, Sequence

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

from sim.diagnosis import RULES, Diagnoses, Finding, Weight, diagnose, findings_text
from sim.diagnosis.rule import Explanation, Rule, RuleFault
from sim.diagnosis.timeline_view import TimelineView
from sim.trace.events import (
    AnyEvent,
    CallbackStarted,
    EntityAppeared,
    EntityId,
    EventsLost,
    WaitStarted,
)
from sim.trace.timeline import Timeline
from tests.ros.scheduling.systems import System, play, systems
from tests.support.builder import Run, ns
from tests.support.properties import examples
from tests.support.runs import shared_group_run
from tests.trace.systems import legal_runs

SLOWER = 20
"""Random systems last two seconds; stretched by so much they last longer than what is looked at again."""


def timeline_of(events: Sequence[AnyEvent]) -> Timeline:
    timeline = Timeline()
    timeline.extend(events)
    return timeline


def stretched(events: Sequence[AnyEvent]) -> Iterator[AnyEvent]:
    """The events of a run in which everything took longer."""
    for event in events:
        later = replace(event, t=event.t * SLOWER)
        match later:
            case WaitStarted(since=since):
                yield replace(later, since=since * SLOWER)
            case CallbackStarted(age=age):
                yield replace(later, age=age * SLOWER)
            case EntityAppeared(period=period):
                yield replace(later, period=period * SLOWER)
            case _:
                yield later


@pytest.mark.filterwarnings("ignore:MultiThreadedExecutor is used with a single thread")
@given(systems(), st.lists(st.floats(0, 1), max_size=8))
@settings(max_examples=examples(40), deadline=None)
def test_looking_at_what_is_new_finds_what_looking_at_everything_does(
    system: System, cuts: list[float]
) -> None:
    events = list(stretched(play(system).events))
    places = sorted({round(cut * len(events)) for cut in cuts} | {len(events)})
    timeline, diagnoses, begin = Timeline(), Diagnoses(), 0
    for end in places:
        timeline.extend(events[begin:end])
        begin = end
        known, anew = diagnoses.update(timeline), diagnose(timeline_of(events[:end]))
        assert list(known) == list(anew)


def test_a_lesson_watched_second_by_second_has_the_same_findings_as_afterwards() -> None:
    events = shared_group_run().events
    timeline, diagnoses, begin = Timeline(), Diagnoses(), 0
    for second in range(31):
        end = next((place for place, each in enumerate(events) if each.t > ns(second)), len(events))
        timeline.extend(events[begin:end])
        begin = end
        diagnoses.update(timeline)
    assert begin == len(events)
    assert diagnoses.findings == diagnose(timeline_of(events))
    assert "dropped-messages" in {each.rule.id for each in diagnoses.findings}


def test_an_update_without_news_changes_nothing() -> None:
    timeline = timeline_of(shared_group_run().events)
    diagnoses = Diagnoses()
    first = diagnoses.update(timeline)
    assert first
    assert diagnoses.update(timeline) == first


def test_another_timeline_begins_anew() -> None:
    diagnoses = Diagnoses()
    assert diagnoses.update(timeline_of(shared_group_run().events))
    assert diagnoses.update(Timeline()) == ()


def test_an_update_asks_for_no_more_than_the_last_seconds() -> None:
    class Watches(Rule):
        id = "watches"
        summary = "notes what it is asked to look at"

        def __init__(self) -> None:
            self.starts: list[int] = []

        def check(self, look: TimelineView) -> Iterator[Finding]:
            self.starts.append(look.window.start)
            return iter(())

        explain = None  # type: ignore[assignment]

    rule = Watches()
    timeline, diagnoses = Timeline(), Diagnoses([rule])
    run = Run("long")
    for minute in range(5):
        run.log("here", minute * 60.0)
        timeline.extend(run.events[-1:])
        diagnoses.update(timeline)
    assert rule.starts == [-1, -1, ns(59), ns(119), ns(179)]


def test_of_all_that_one_culprit_keeps_the_worst_that_matters_is_found_with_its_own_count() -> None:
    class Keeps(Rule):
        id, summary, by_culprit = "keeps", "one keeps others", True

        def check(self, view: TimelineView) -> Iterator[Finding]:
            for subject, size in ((1, 9), (2, 3), (2, 5), (3, 4)):
                yield Finding(self, 0, view.end, subject, culprit=7, size=size)

        def explain(self, found: Finding, timeline: Timeline) -> Explanation:
            raise AssertionError

        def weigh(self, found: Finding, timeline: Timeline) -> Weight | None:
            return self.weight if found.subject != 1 else None

    (found,) = Diagnoses([Keeps()]).update(timeline_of(shared_group_run().events))
    assert (found.subject, found.size, found.count) == (2, 5, 2)


class Found(Rule):
    """Finds what it is given."""

    by_culprit = True
    summary = ""

    def __init__(self, rule_id: str, weight: Weight, *found: tuple[float, EntityId, EntityId]) -> None:
        self.id, self.weight, self._found = rule_id, weight, found  # type: ignore[misc]

    def check(self, view: TimelineView) -> Iterator[Finding]:
        return (Finding(self, ns(at), view.end, 1, who, due_to=to) for at, who, to in self._found)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        return Explanation("", "", "", None)


def test_problems_come_by_rule_and_then_remarks_by_time_wherever_they_come_from() -> None:
    rules = (
        Found("worst", Weight.PROBLEM, (5.0, 1, 0)),
        Found("bad", Weight.PROBLEM, (3.0, 2, 0), (2.0, 3, 0)),
        Found("of the whole run", Weight.REMARK, (0.0, 4, 0)),
        Found("part of the worst", Weight.REMARK, (6.0, 5, 1)),
        Found("early", Weight.REMARK, (1.0, 6, 0)),
    )
    found = Diagnoses(rules).update(timeline_of(shared_group_run().events))
    assert [(each.rule.id, each.at) for each in found] == [
        ("worst", ns(5.0)),
        ("bad", ns(2.0)),
        ("bad", ns(3.0)),
        ("early", ns(1.0)),
        ("part of the worst", ns(6.0)),
        ("of the whole run", 0),
    ]


def test_each_rule_has_an_id_of_its_own_and_says_what_it_looks_for() -> None:
    assert len({rule.id for rule in RULES}) == len(RULES)
    assert all(rule.summary and rule.__doc__ for rule in RULES)


def test_the_list_has_a_sign_a_reason_a_cure_and_a_place_for_each_finding() -> None:
    timeline = timeline_of(shared_group_run().events)
    lines = findings_text(diagnose(timeline), timeline).splitlines()
    assert lines[0] == "Diagnosis"
    begin = next(place for place, line in enumerate(lines) if "scan_callback waited" in line)
    assert lines[begin : begin + 9] == [
        "  ! odom_callback and scan_callback waited up to 20.0 s: group A was held by",
        "    timer_callback.",
        "    A mutually exclusive group lets one callback in at a time, however many",
        "    threads are free.",
        "    → give timer_callback a callback group of its own, and spin with",
        "      MultiThreadedExecutor(num_threads=2); or let timer_callback return",
        "      sooner.",
        "      node.py:120, at 4.003 s",
        "  · timer_callback took 10.0 s with a period of 500 ms; 19 ticks missed or late",
    ]
    assert max(map(len, lines)) <= 79


def test_of_a_call_that_still_runs_it_is_told_how_long_so_far() -> None:
    timeline = timeline_of(shared_group_run().until(9.0))
    told = next(each for each in diagnose(timeline) if each.rule.id == "overrun-timer").explained(timeline)
    assert told.what.startswith("timer_callback has run for 5.0 s so far with a period of 500 ms; 9 ticks ")


def test_where_nothing_was_found_the_list_is_silent() -> None:
    assert findings_text((), Timeline()) == ""


def test_a_trace_that_lacks_events_says_so_beside_what_it_finds() -> None:
    run = Run("busy")
    run.log("here", 1.0)
    assert diagnose(timeline_of(run.events)) == ()
    run.add(EventsLost(ns(2.0), 1200))
    timeline = timeline_of(run.events)
    (found,) = diagnose(timeline)
    assert (found.rule.id, found.weight_in(timeline)) == ("gaps-in-trace", Weight.REMARK)
    told = found.explained(timeline).what
    assert told.startswith("1,200 events are missing from the trace")


@given(legal_runs(), st.integers(0, 2**64 - 1))
def test_a_trace_with_gaps_can_be_looked_at_too(events: list[AnyEvent], kept: int) -> None:
    timeline = timeline_of([event for place, event in enumerate(events) if kept >> place % 64 & 1])
    findings_text(diagnose(timeline), timeline)


class FailsToCheck(Rule):
    id = "fails-to-check"
    summary = "a rule with a fault"

    def check(self, view: TimelineView) -> Iterator[Finding]:
        yield Finding(self, ns(1.0), ns(1.0), about="first")
        raise LookupError("no second one")

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        return Explanation("told", "", "", None)


class FailsToTell(FailsToCheck):
    id = "fails-to-tell"

    def check(self, view: TimelineView) -> Iterator[Finding]:
        yield Finding(self, ns(2.0), ns(2.0))

    def weigh(self, found: Finding, timeline: Timeline) -> Weight | None:
        raise LookupError("no weight")

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        raise LookupError("no words")


@pytest.mark.filterwarnings("ignore::sim.diagnosis.rule.RuleFault")
def test_a_rule_that_fails_is_told_and_leaves_the_others_findings() -> None:
    timeline = timeline_of(shared_group_run().events)
    found = Diagnoses((FailsToCheck(), FailsToTell(), *RULES)).update(timeline)
    assert [each for each in found if each.rule in RULES] == list(diagnose(timeline))
    first, wordless, failed = [each.explained(timeline) for each in found if each.rule not in RULES]
    assert first.what == "told"
    line = FailsToTell.explain.__code__.co_firstlineno + 1
    assert wordless.what == "a rule with a fault"
    assert f"LookupError: no words (test_diagnoses.py:{line})" in wordless.why
    assert failed.what == "cbtui could not check this: a rule with a fault"
    assert failed.why.startswith("LookupError: no second one")


def test_a_rule_that_fails_is_warned_of_for_those_who_ask() -> None:
    with pytest.warns(RuleFault, match="fails-to-check: LookupError: no second one"):
        Diagnoses((FailsToCheck(),)).update(timeline_of(shared_group_run().events))
