"""Moving through the time of runs, without a screen."""

from collections.abc import Callable

import pytest

from cbtui.runs.live.live_run import LiveRun
from cbtui.screens.parts.narration import was_stepped
from cbtui.screens.parts.navigation import MomentKey, TimeNavigation
from sim.engine.commands import Command, Pause, RunUntil, Step
from sim.engine.setup import RunSetup
from sim.trace.events import TimePassed
from sim.trace.timeline import Timeline
from tests.screens.parts.hosts import FakeHost
from tests.support.builder import ns
from tests.support.fake_session import FakeEngines
from tests.support.runs import dummy_server_run, shared_group_run
from tests.widgets.pictures import told

NOW_OR_NEVER = ("to_end", "later", "step", "pan_later")
"""Actions that go towards the present."""


def over(*timelines: Timeline) -> tuple[TimeNavigation, Callable[[], int]]:
    moves: list[None] = []
    navigation = TimeNavigation(
        lambda: timelines, lambda: max(each.end for each in timelines), lambda: moves.append(None)
    )
    return navigation, lambda: len(moves)


def test_at_the_end_of_a_run_that_is_over_only_the_past_is_offered() -> None:
    navigation, _ = over(told(shared_group_run()))
    assert not any(navigation.offers(action, ()) for action in NOW_OR_NEVER)
    assert navigation.offers("earlier", ())
    assert navigation.offers("step_back", ())
    navigation.action_earlier()
    assert all(navigation.offers(action, ()) for action in ("to_end", "later", "step"))


def test_every_move_is_told() -> None:
    navigation, moves = over(told(shared_group_run()))
    navigation.action_zoom_in()
    navigation.action_pan_earlier()
    navigation.action_step_back()
    navigation.action_live()
    assert moves() == 4
    assert navigation.playhead.follows


def test_before_the_first_event_a_step_back_leads_to_the_beginning() -> None:
    navigation, _ = over(told(shared_group_run()))
    first = navigation.timelines()[0].neighbour(0, 1)
    assert first
    navigation.seek(first)
    navigation.action_step_back()
    assert navigation.now == 0
    assert not navigation.offers("step_back", ())


def test_steps_go_through_the_decisions_of_a_moment_before_they_leave_it() -> None:
    navigation, _ = over(told(shared_group_run()))
    navigation.decisions = lambda: 2
    navigation.seek(ns(5.0))
    navigation.action_step_back()
    assert (navigation.now, navigation.place) == (ns(5.0), 0), "the newest one is on screen before it"
    navigation.action_step_back()
    moments = [(navigation.now, navigation.place)]
    for step in (navigation.action_step_back, navigation.action_step, navigation.action_step):
        step()
        moments.append((navigation.now, navigation.place))
    (event, _), *_, (following, _) = moments
    assert moments == [(event, 1), (event, 0), (event, 1), (following, 0)]
    assert following > event


def test_of_two_runs_the_nearer_event_is_next() -> None:
    runs = told(shared_group_run()), told(dummy_server_run())
    navigation, _ = over(*runs)
    navigation.seek(ns(5.0))
    navigation.action_step()
    after = [timeline.neighbour(ns(5.0), 1) for timeline in runs]
    assert navigation.now == min(at for at in after if at is not None)


def test_the_longest_stretch_cannot_be_zoomed_out_of() -> None:
    navigation, _ = over(told(shared_group_run()))
    navigation.zoom(100)
    assert not navigation.offers("zoom_out", ())
    assert navigation.offers("zoom_in", ())


@pytest.fixture
def engines() -> FakeEngines:
    return FakeEngines(shared_group_run().events, ns(5.0))


def live(engines: FakeEngines) -> tuple[LiveRun, TimeNavigation]:
    run = LiveRun(RunSetup(title="x", programs=()), engines, lambda events: None, lambda loss: None)
    run.take([event for event in shared_group_run().events if event.t <= ns(5.0)])
    return run, TimeNavigation(
        lambda: [run.timeline], lambda: run.timeline.end, lambda: None, live=lambda: run
    )


def commands(engines: FakeEngines) -> list[Command]:
    return engines.latest.commands


def test_a_step_at_the_end_is_the_engines_and_one_in_the_past_is_not(engines: FakeEngines) -> None:
    run, navigation = live(engines)
    assert not navigation.offers("step", ())
    run.pause()
    assert navigation.offers("step", ())
    navigation.action_step()
    navigation.action_earlier()
    navigation.action_step()
    assert commands(engines) == [Pause(), Step()]


def test_looking_back_goes_through_the_moments_from_which_steps_began(engines: FakeEngines) -> None:
    run, navigation = live(engines)
    run.pause()
    between = [ns(5.25), ns(5.26), ns(5.27)]
    for at in between:
        navigation.action_step()
        run.take([TimePassed(at)])
    reached = []
    for _ in range(3):
        navigation.action_step_back()
        assert was_stepped(run, navigation)
        reached.append(navigation.now)
    assert reached == [ns(5.26), ns(5.25), run.stops[0]]
    navigation.action_step()
    assert navigation.now == ns(5.25)
    navigation.seek(ns(5.1))
    assert not was_stepped(run, navigation)


def test_a_moment_to_come_is_run_to_and_one_that_has_passed_is_looked_at(engines: FakeEngines) -> None:
    host = FakeHost(answers=[ns(3.0), ns(60.0), None])
    _, navigation = live(engines)
    key = MomentKey(host, navigation)
    key.action_go_to_time()
    assert (navigation.now, commands(engines)) == (ns(3.0), [])
    key.action_go_to_time()
    assert navigation.playhead.follows
    assert commands(engines) == [RunUntil(ns(60.0))]
    key.action_go_to_time()
    assert len(commands(engines)) == 1
