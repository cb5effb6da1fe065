"""What holds of every system in every order of its threads, and that an order that breaks it is found."""

from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sim.ros.middleware.host import current_host
from sim.ros.scheduling.callback_groups import MutuallyExclusiveCallbackGroup
from sim.ros.scheduling.cycle import Cycle
from sim.ros.scheduling.racing import RacingCycle
from sim.ros.scheduling.running import CallbackRunner
from tests.ros.scheduling.schedules import broken_rules, first_trouble, play_seeded
from tests.ros.scheduling.systems import System, play, systems
from tests.support.properties import examples

pytestmark = pytest.mark.filterwarnings("ignore:MultiThreadedExecutor is used with a single thread")

each_schedule = settings(
    deadline=None, max_examples=examples(40), suppress_health_check=[HealthCheck.too_slow]
)
SEEDS = st.integers(1, 2**32 - 1)
ENOUGH = range(1, 1000)
"""Schedules within which a fault is found that no run in the usual order shows."""


@each_schedule
@given(systems(), SEEDS)
def test_an_executor_keeps_its_rules_in_every_order_of_threads(system: System, seed: int) -> None:
    assert not list(broken_rules(system, play_seeded(system, seed)))


@settings(each_schedule, max_examples=examples(30))
@given(systems(), SEEDS)
def test_a_seed_gives_the_same_run_each_time(system: System, seed: int) -> None:
    assert play_seeded(system, seed).events == play_seeded(system, seed).events


@settings(each_schedule, max_examples=examples(15))
@given(systems())
def test_seed_0_is_the_usual_order(system: System) -> None:
    assert play_seeded(system, 0).events == play(system).events


def test_systems_of_many_seeds_keep_the_rules() -> None:
    assert first_trouble(range(1, 100)) is None


# Executors that were broken on purpose


def usual_order(system: System, seed: int) -> Any:
    return play(system)


def assert_only_exploring_finds(words: str) -> None:
    found = first_trouble(ENOUGH)
    assert found is not None
    assert words in found.what
    assert first_trouble(range(found.seed, found.seed + 1), usual_order) is None


def let_go_of_the_lock() -> None:
    """Let others have the host's lock, on a thread that holds it."""
    lock = current_host().lock
    lock.__exit__(None, None, None)
    lock.__enter__()


def before(inner: Callable[..., Any], first: Callable[[], None]) -> Callable[..., Any]:
    def outer(*args: Any) -> Any:
        first()
        return inner(*args)

    return outer


def test_a_group_that_asks_and_enters_in_two_steps_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    def begin(group: MutuallyExclusiveCallbackGroup, entity: Any) -> bool:
        if group._active_entity is not None:
            return False
        let_go_of_the_lock()
        group._active_entity = entity
        return True

    def end(group: MutuallyExclusiveCallbackGroup, entity: Any) -> None:
        group._active_entity = None

    monkeypatch.setattr(MutuallyExclusiveCallbackGroup, "beginning_execution", begin)
    monkeypatch.setattr(MutuallyExclusiveCallbackGroup, "ending_execution", end)
    assert_only_exploring_finds("two callbacks are in an exclusive group")


def test_a_wake_up_that_is_lost_between_looking_and_waiting_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    looks = Cycle.next

    def look(cycle: Cycle, now: int) -> Any:
        work = looks(cycle, now)
        if work is None:
            let_go_of_the_lock()  # what becomes ready here finds nobody waiting, and wakes nobody
        return work

    monkeypatch.setattr(Cycle, "next", look)
    assert_only_exploring_finds("a wake-up was lost")


def test_a_wake_up_that_racing_threads_lose_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(RacingCycle, "woken", lambda cycle: None)
    assert_only_exploring_finds("a wake-up was lost")


def test_a_start_that_is_told_of_late_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(CallbackRunner, "start", before(CallbackRunner.start, let_go_of_the_lock))
    assert_only_exploring_finds("it was not the oldest")
