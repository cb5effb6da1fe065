"""A recording that begins in the middle of a run shows the present as one that was there from the start."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace

from sim.diagnosis import Explanation, diagnose
from sim.recording import RunSnapshot
from sim.ros.node.node import Node
from sim.ros.scheduling.callback_groups import MutuallyExclusiveCallbackGroup
from sim.trace.events import (
    AnyEvent,
    CallbackStarted,
    EntityGone,
    EntityReady,
    MessageDropped,
    RunStarted,
    TopicAppeared,
)
from sim.trace.figures.summary import summarise
from sim.trace.timeline import Timeline
from tests.diagnosis.findings import SetBool, diagnosed, once, spin
from tests.recording.files import TOPICS, timeline_of
from tests.support.builder import ns
from tests.support.daily import first_slow
from tests.support.runs import dummy_server_run, shared_group_run
from tests.trace.samples import CAST
from tests.trace.systems import legal_runs


def begun_at(events: list[AnyEvent], cut: int) -> list[AnyEvent]:
    """What a recording holds that begins after so many events."""
    snapshot = RunSnapshot()
    for event in events[:cut]:
        snapshot.take([event])
    return [*snapshot.events(), *events[cut:]]


@given(legal_runs(), st.integers(0, 100))
def test_from_its_beginning_on_every_moment_is_that_of_the_run(events: list[AnyEvent], cut: int) -> None:
    assert_same_from(events, min(cut, len(events)))


@pytest.mark.parametrize("step", first_slow(5011, 311))
def test_lessons_can_be_recorded_from_any_event_on(step: int) -> None:
    for run in (shared_group_run(), dummy_server_run()):
        for cut in range(0, len(run.events), step):
            assert_same_from(run.events, cut)


def assert_same_from(events: list[AnyEvent], cut: int) -> None:
    whole, late = timeline_of([events]), timeline_of([begun_at(events, cut)])
    first = events[cut - 1].t if cut else 0
    assert late.begun == (max(event.t for event in events[:cut]) if cut and whole.started else 0)
    assert late.started == (whole.started and replace(whole.started, known_from=late.begun))
    assert (late.threads, late.nodes, late.groups) == (whole.threads, whole.nodes, whole.groups)
    assert late.entities == whole.entities
    for at in {first, *(event.t for event in events[cut:])} - {event.t for event in events[:cut]} | {first}:
        moment, expected = late.moment(at), whole.moment(at)
        assert moment.running == expected.running
        assert moment.waiting == expected.waiting
        assert moment.holders == expected.holders
        assert moment.pending_calls == expected.pending_calls
        assert moment.blocked == expected.blocked
        assert [late.position_on(each, at) for each in late.threads] == [
            whole.position_on(each, at) for each in whole.threads
        ]
        assert {e: (q.depth, q.messages) for e, q in moment.queues.items()} == {
            e: (q.depth, q.messages) for e, q in expected.queues.items()
        }
        assert late.robot(at) == whole.robot(at)
        assert late.scan(at) == whole.scan(at)


def test_a_message_that_expired_before_an_older_one_is_not_told_again() -> None:
    arrived: list[AnyEvent] = [EntityReady(1, 1, 1, 4), EntityReady(2, 1, 2, 5)]
    for left in (MessageDropped(3, 1, 1, 5), CallbackStarted(3, 1, 1, 5, 0, 1)):
        assert_same_from([*CAST, *arrived, left, EntityReady(4, 1, 2, 6)], len(CAST) + 3)


def test_topics_are_told_again_and_what_is_gone_is_not() -> None:
    snapshot = RunSnapshot()
    snapshot.take([*CAST, *TOPICS, EntityGone(5, 1)])
    told = snapshot.events()
    assert [event for event in told if isinstance(event, TopicAppeared)] == TOPICS
    assert len(told) == len(CAST) + len(TOPICS) - 1


def test_what_lasts_when_a_recording_is_begun_is_found_in_it_and_nothing_else() -> None:
    def program(_: object) -> None:
        node, shared = Node("node"), MutuallyExclusiveCallbackGroup()
        client = node.create_client(SetBool, "/outside", callback_group=shared)
        node.create_service(SetBool, "/outside", lambda _, response: response)
        once(node, 1.0, lambda: client.call(SetBool.Request()), shared)
        node.create_timer(0.5, lambda: None, MutuallyExclusiveCallbackGroup())
        spin(node, 4)

    whole = diagnosed(program)
    events, stuck = whole.trace.events, whole.explained("self-made-deadlock")
    for until in (8, 9.5):
        cut = 1 + sum(event.t <= ns(until) for event in events)
        late = timeline_of([begun_at([RunStarted(0, "node", "virtual", 0), *events], cut)])
        assert [(each.what, each.place) for each in found_in(late)] == [(stuck.what, stuck.place)]
        figures = summarise(late)
        assert figures.length == late.end - late.begun <= ns(10 - until)
        assert max(each.running for each in figures.callbacks) == 1.0


def found_in(timeline: Timeline) -> list[Explanation]:
    return [found.explained(timeline) for found in diagnose(timeline)]
