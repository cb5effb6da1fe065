"""A deadlock is found exactly where nothing can run any more, as the scheduler itself tells."""

import pytest
from hypothesis import event, given, settings

from sim.diagnosis import Finding, diagnose
from sim.trace.timeline import Timeline
from tests.diagnosis.calling_systems import CallingSystem, calling_systems, play

DEADLOCKS = {"self-made-deadlock", "needs-one-more-worker"}

pytestmark = pytest.mark.filterwarnings("ignore:MultiThreadedExecutor is used with a single thread")


def deadlocks(timeline: Timeline) -> list[Finding]:
    return [each for each in diagnose(timeline) if each.rule.id in DEADLOCKS]


@given(calling_systems())
@settings(max_examples=60, deadline=None)
def test_a_deadlock_is_found_where_callbacks_never_end_and_only_there(system: CallingSystem) -> None:
    run, fate = play(system)
    assert not fate.something_can_run
    event(f"stuck: {bool(fate.unfinished)}")
    found = [each for each in deadlocks(run.timeline) if each.until == run.timeline.end]
    assert bool(found) == bool(fate.unfinished)


@given(calling_systems())
@settings(max_examples=60, deadline=None)
def test_where_all_goes_well_in_the_end_no_deadlock_is_seen_on_the_way(system: CallingSystem) -> None:
    run, fate = play(system)
    if fate.unfinished:
        return
    timeline = Timeline()
    for each in run.trace.events:
        timeline.extend([each])
        assert deadlocks(timeline) == []
