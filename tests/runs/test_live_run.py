import pytest
from msgspec import structs

from cbtui.engines.session import Deliver, Ended
from cbtui.runs.live.live_run import LiveRun, RunState
from sim.engine.commands import (
    CallService,
    Pause,
    ResetWorld,
    Resume,
    RunUntil,
    SetSpeed,
    Step,
)
from sim.engine.setup import ProgramSetup, RunSetup, ServiceChoice
from sim.engine.time_control import given, in_words
from sim.trace.events import AnyEvent, RunEnded, RunStarted, TimeHalted
from tests.support.fake_session import FakeEngines, FakeSession

SETUP = RunSetup(
    title="x",
    programs=(ProgramSetup("node.py"),),
    service=ServiceChoice("/motor_power", "std_srvs/srv/SetBool"),
)


@pytest.fixture
def engines() -> FakeEngines:
    return FakeEngines([RunStarted(0, "x", "virtual", 0), RunEnded(5, "its time was up", False)], until=-1)


@pytest.fixture
def run(engines: FakeEngines) -> LiveRun:
    def deliver(events: list[AnyEvent]) -> None:
        live.take(events)

    def ended(loss: str | None) -> None:
        live.over(loss)

    live = LiveRun(SETUP, engines, deliver, ended)
    live.start()
    return live


def state_of(run: LiveRun) -> RunState:
    return run.state


@pytest.fixture
def session(engines: FakeEngines, run: LiveRun) -> FakeSession:
    return engines.latest


def test_a_step_that_is_told_of_after_one_has_gone_on_does_not_pause_the_run(run: LiveRun) -> None:
    run.pause()
    run.step()
    run.resume()
    run.take([RunStarted(0, "x", "virtual", 0), given(1, Step()), TimeHalted(1, "step")])
    run.take([given(1, Resume())])
    assert state_of(run) is RunState.LIVE


def test_a_run_that_goes_on_to_a_moment_is_not_paused_by_the_step_before(run: LiveRun) -> None:
    goal = RunUntil(5)
    run.step()
    run.run_until(5)
    run.take([RunStarted(0, "x", "virtual", 0), TimeHalted(1, "step"), given(1, goal)])
    assert state_of(run) is RunState.LIVE
    run.take([TimeHalted(5, in_words(goal))])
    assert state_of(run) is RunState.PAUSED


def test_who_pauses_is_not_overruled_by_what_was_asked_before(run: LiveRun) -> None:
    run.resume()
    run.pause()
    run.take([RunStarted(0, "x", "virtual", 0), given(0, Resume())])
    assert state_of(run) is RunState.PAUSED


def test_a_run_starts_with_its_first_event(run: LiveRun, session: FakeSession) -> None:
    assert state_of(run) is RunState.STARTING
    session.play(0)
    assert state_of(run) is RunState.LIVE


def test_a_run_ends_with_its_last_event_even_before_its_process(run: LiveRun, session: FakeSession) -> None:
    session.play(5)
    assert state_of(run) is RunState.ENDED
    assert not run.alive


def test_a_run_whose_engine_is_gone_is_lost_whatever_it_told_before(
    run: LiveRun, session: FakeSession
) -> None:
    session.play(0)
    session.end("the engine was killed by signal 9")
    assert state_of(run) is RunState.LOST
    assert run.loss == "the engine was killed by signal 9"


def test_a_run_that_cannot_be_started_is_lost() -> None:
    class NoProcess(FakeSession):
        def start(self) -> None:
            raise OSError(12, "Cannot allocate memory")

    def open_session(setup: RunSetup, deliver: Deliver, ended: Ended) -> FakeSession:
        return NoProcess(setup, deliver, ended, [], 0)

    run = LiveRun(SETUP, open_session, lambda _: None, lambda _: None)
    run.start()
    assert run.loss == "it could not be started: Cannot allocate memory"
    run.stop()


def test_pause_and_resume_reach_the_engine(run: LiveRun, session: FakeSession) -> None:
    session.play(0)
    run.pause()
    assert state_of(run) is RunState.PAUSED
    run.resume()
    assert state_of(run) is RunState.LIVE
    assert session.commands == [Pause(), Resume()]


def test_a_call_goes_to_the_service_of_the_set_up(run: LiveRun, session: FakeSession) -> None:
    run.call(True)
    run.reset_world()
    assert session.commands == [CallService("/motor_power", True), ResetWorld()]


def test_speed_ends_at_as_fast_as_it_can(run: LiveRun, session: FakeSession) -> None:
    for _ in range(10):
        run.change_speed(1)
    assert run.speed is None
    assert session.commands[-1] == SetSpeed(None)
    run.change_speed(-1)
    assert session.commands[-1] == SetSpeed(20.0)


def test_speed_ends_at_a_tenth(run: LiveRun) -> None:
    for _ in range(10):
        run.change_speed(-1)
    assert run.speed == 0.1


def test_a_run_that_goes_on_to_a_goal_is_live_until_the_engine_says_that_time_stands(
    run: LiveRun, session: FakeSession
) -> None:
    session.play(0)
    run.pause()
    run.run_until(9)
    assert state_of(run) is RunState.LIVE
    run.take([TimeHalted(9, "run until")])
    assert state_of(run) is RunState.PAUSED
    run.step()
    assert state_of(run) is RunState.PAUSED
    assert session.commands == [Pause(), RunUntil(9), Step()]


def test_the_real_clock_has_speeds_but_none_without_limit() -> None:
    engines = FakeEngines([], until=-1)
    setup = structs.replace(SETUP, clock="real", speed=None)
    run = LiveRun(setup, engines, lambda _: None, lambda _: None)
    assert run.speed == 1.0
    for _ in range(10):
        run.change_speed(1)
    assert run.speed == 20.0


def test_a_run_has_a_goal_until_another_command_for_time(run: LiveRun) -> None:
    for other in (run.pause, run.resume, run.step):
        run.run_until(5)
        assert run.goal == 5
        other()
        assert run.goal is None
