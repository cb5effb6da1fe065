"""What holds of every system of nodes, groups and threads, whatever it consists of."""

from collections import Counter

import pytest
from hypothesis import HealthCheck, given, settings

from sim.trace.events import (
    CallbackStarted,
    EntityKind,
    Published,
    Reason,
    WaitEnded,
    WaitStarted,
)
from tests.ros.scheduling.replay import Replay
from tests.ros.scheduling.systems import System, play, systems
from tests.support.properties import examples

pytestmark = pytest.mark.filterwarnings("ignore:MultiThreadedExecutor is used with a single thread")

each_system = settings(deadline=None, max_examples=examples(40), suppress_health_check=[HealthCheck.too_slow])


@each_system
@given(systems())
def test_no_two_callbacks_of_an_exclusive_group_overlap(system: System) -> None:
    trace = play(system)
    replay = Replay(trace)
    for event in trace.events:
        if isinstance(event, CallbackStarted):
            assert replay.may_enter(event.entity)
        replay.take(event)


@each_system
@given(systems())
def test_never_more_callbacks_at_once_than_threads(system: System) -> None:
    trace = play(system)
    replay = Replay(trace)
    for event in trace.events:
        replay.take(event)
        assert replay.running.total() <= system.workers


@each_system
@given(systems())
def test_when_time_passes_nothing_ready_waits_for_a_free_group_and_an_idle_worker(system: System) -> None:
    replay = Replay(play(system))
    for now in replay.jumps():
        if replay.running.total() < system.workers:
            assert not [entity for entity in replay.ready(now) if replay.may_enter(entity)]


@each_system
@given(systems())
def test_when_time_passes_whatever_is_ready_and_does_not_run_is_explained(system: System) -> None:
    replay = Replay(play(system))
    for now in replay.jumps():
        assert set(replay.waiting) == set(replay.ready(now))


@each_system
@given(systems())
def test_every_message_is_taken_or_dropped_once_and_in_order(system: System) -> None:
    trace = play(system)
    replay = Replay(trace)
    list(replay.jumps())
    for entity, appeared in replay.entities.items():
        if appeared.kind == EntityKind.SUBSCRIPTION:
            sent = [each.message for each in trace.of(Published) if each.topic == appeared.name]
            assert [*replay.removed[entity], *replay.queues[entity]] == sent
            assert len(replay.queues[entity]) <= appeared.depth


@each_system
@given(systems())
def test_every_reason_for_waiting_is_true_at_its_moment(system: System) -> None:
    trace = play(system)
    replay = Replay(trace)
    for event in trace.events:
        replay.take(event)
        if isinstance(event, WaitStarted):
            busy = replay.running.total() == system.workers
            assert event.entity in replay.ready(event.t)
            assert event.since <= event.t
            assert event.workers_busy == busy
            if event.reason == Reason.GROUP_HELD:
                assert [event.holder] == replay.inside(event.entity)
                assert not replay.may_enter(event.entity)
            else:
                assert event.reason == Reason.NO_FREE_WORKER
                assert busy
                assert replay.running[event.holder] > 0
                assert replay.may_enter(event.entity)


@each_system
@given(systems())
def test_a_wait_ends_before_its_callback_begins_and_only_a_wait_that_began_ends(system: System) -> None:
    trace = play(system)
    replay = Replay(trace)
    for event in trace.events:
        if isinstance(event, CallbackStarted):
            assert event.entity not in replay.waiting
        if isinstance(event, WaitEnded):
            assert event.entity in replay.waiting
        replay.take(event)


@each_system
@given(systems())
def test_the_same_system_runs_the_same_each_time(system: System) -> None:
    assert play(system).events == play(system).events


@each_system
@given(systems())
def test_a_timeline_shows_at_each_moment_what_the_trace_says(system: System) -> None:
    trace = play(system)
    timeline, replay = trace.timeline(), Replay(trace)
    for now in replay.jumps():
        moment = timeline.moment(now)
        assert Counter(span.entity for span in moment.running.values()) == +replay.running
        assert {entity: wait.reason for entity, wait in moment.waiting.items()} == {
            entity: wait.reason for entity, wait in replay.waiting.items()
        }
        for entity, queue in replay.queues.items():
            assert timeline.queue(entity, now).depth == len(queue)
