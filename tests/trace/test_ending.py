"""What a program does after it was told to end is on the trace, and no check looks at it."""

from sim.trace.ending import UntilEnding
from sim.trace.events import (
    AnyEvent,
    CallbackEnded,
    CallbackStarted,
    Logged,
    Printed,
    RunEnded,
    RunEnding,
    Severity,
)
from sim.trace.timeline import Timeline

EVENTS: list[AnyEvent] = [
    CallbackStarted(8, 1, 1, message=0, age=0, depth=0),
    RunEnding(10, "its time was up"),
    Printed(11, "motors off", False),
    Logged(12, Severity.INFO, "node", "bye", 0, 0),
    CallbackEnded(13, 1, 1),
    RunEnded(14, "its time was up", failed=False),
]


def test_what_it_says_in_its_ending_counts_as_of_the_moment_it_was_told() -> None:
    ending = UntilEnding()
    kept = [event for half in (EVENTS[:3], EVENTS[3:]) for event in ending.cut(half)]
    assert [type(event) for event in kept] == [CallbackStarted, RunEnding, Printed, Logged, RunEnded]
    assert [event.t for event in kept] == [8, 10, 10, 10, 10]


def test_a_program_that_ends_by_itself_counts_whole() -> None:
    events = [event for event in EVENTS if not isinstance(event, RunEnding)]
    assert [*UntilEnding().cut(events)] == events


def test_a_timeline_ends_where_the_program_was_told_to_unless_it_is_to_show_the_ending() -> None:
    last = [EVENTS[1], EVENTS[-1]]
    whole, counted = Timeline(), Timeline(until_ending=True)
    for timeline in (whole, counted):
        timeline.extend(last)
    assert (whole.end, counted.end) == (14, 10)
    assert counted.ended == RunEnded(10, "its time was up", failed=False)
