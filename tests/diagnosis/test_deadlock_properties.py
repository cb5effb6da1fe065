"""A deadlock is found exactly where callbacks can never go on, as the scheduler and they themselves tell."""

from collections.abc import Callable

import pytest
from hypothesis import Phase, event, find, given, settings

from sim.diagnosis import Finding, diagnose
from sim.trace.timeline import Timeline
from tests.diagnosis.calling_systems import CallingSystem, Fate, calling_systems, play
from tests.support.properties import examples

DEADLOCKS = {"self-made-deadlock", "needs-one-more-worker"}

pytestmark = pytest.mark.filterwarnings("ignore:MultiThreadedExecutor is used with a single thread")

each_system = settings(max_examples=examples(60), deadline=None)


def deadlocks(timeline: Timeline) -> list[Finding]:
    return [each for each in diagnose(timeline) if each.rule.id in DEADLOCKS]


@given(calling_systems())
@each_system
def test_a_deadlock_is_found_where_callbacks_never_end_and_only_there(system: CallingSystem) -> None:
    run, fate = play(system)
    assert fate.something_can_run == fate.heart_beats
    event(f"stuck: {bool(fate.unfinished)}, something goes on: {fate.heart_beats}")
    found = [each for each in deadlocks(run.timeline) if each.until == run.timeline.end]
    assert bool(found) == bool(fate.unfinished)


@given(calling_systems())
@each_system
def test_where_all_goes_well_in_the_end_no_deadlock_is_seen_on_the_way(system: CallingSystem) -> None:
    run, fate = play(system)
    if fate.unfinished:
        return
    timeline = Timeline()
    for each in run.trace.events:
        timeline.extend([each])
        assert deadlocks(timeline) == []


@pytest.mark.parametrize(
    "fate_is",
    [
        lambda fate: fate.unfinished and not fate.something_can_run,
        lambda fate: fate.unfinished and fate.heart_beats,
        lambda fate: not fate.unfinished and not fate.something_can_run,
        lambda fate: not fate.unfinished and fate.heart_beats,
    ],
    ids=["all stuck", "stuck beside others", "all done", "done, and going on"],
)
def test_among_the_systems_is_every_fate(fate_is: Callable[[Fate], bool]) -> None:
    once = settings(max_examples=200, deadline=None, database=None, phases=[Phase.generate])
    find(calling_systems(), lambda system: bool(fate_is(play(system)[1])), settings=once)
