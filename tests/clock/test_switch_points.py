"""Where a virtual clock that explores orders does not switch, though somebody asks."""

import threading
from collections.abc import Callable

import pytest

from sim.clock import VirtualClock, recesses
from sim.clock.strategies import PctSchedule
from tests.support.simulation import EndedClock, no_thread_left

SEEDS = range(1, 9)
_PATIENCE = 60.0


def run(seed: int, program: Callable[[VirtualClock], object]) -> None:
    """Run a program on a main thread of its own; what it raises is raised."""
    trouble: list[BaseException] = []

    def main() -> None:
        clock = EndedClock(schedule=PctSchedule(seed))
        try:
            program(clock)
        except BaseException as error:  # noqa: BLE001 -- it belongs to the test's own thread
            trouble.append(error)
        clock.wind_up()

    with no_thread_left():
        thread = threading.Thread(target=main, name="MainThread", daemon=True)
        thread.start()
        thread.join(_PATIENCE)
        assert not thread.is_alive(), "the threads stand still"
    if trouble:
        raise trouble[0]


def start_busy(clock: VirtualClock, number: int) -> None:
    def busy() -> None:
        for _ in range(60):
            clock.sleep(0)
            clock.switch_point()

    for _ in range(number):
        clock.start_thread(busy, "busy")


@pytest.mark.parametrize("seed", SEEDS)
def test_a_recess_is_no_place_to_switch(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(recesses, "WAITS_TO_RECESS", 2)

    found = []

    def program(clock: VirtualClock) -> None:
        def busy() -> None:
            for _ in range(60):
                clock.sleep(0)
                found.append(clock.time.recesses.current)

        clock.time.before_jump = clock.switch_point
        clock.time.on_recess = lambda _: clock.switch_point()
        for _ in range(3):
            clock.start_thread(busy, "busy")
        clock.sleep(1_000_000_000)
        assert found
        assert not any(found), "a thread went on while another one was in a recess"

    run(seed, program)


@pytest.mark.parametrize("seed", SEEDS)
def test_nobody_goes_on_while_time_stands_in_a_moment(seed: int) -> None:
    def program(clock: VirtualClock) -> None:
        gone_on = []

        def other() -> None:
            for _ in range(20):
                gone_on.append(stands)
                clock.sleep(0)

        def steer() -> None:
            for _ in range(20):
                clock.switch_point()
            clock.time.resume()

        stands = False
        for _ in range(3):
            clock.start_thread(other, "other")
        for _ in range(10):
            clock.switch_point()
            clock.time.steer(steer)
            stands = True
            clock.halt()
            stands = False
        clock.sleep(0)
        assert gone_on
        assert not any(gone_on)

    run(seed, program)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_thread_that_is_held_together_is_not_left(seed: int) -> None:
    def program(clock: VirtualClock) -> None:
        inside = [0]

        def enter() -> None:
            for _ in range(30):
                clock.no_switching += 1
                inside[0] += 1
                clock.switch_point()
                assert inside[0] == 1
                inside[0] -= 1
                clock.no_switching -= 1
                clock.switch_point()

        for _ in range(3):
            clock.start_thread(enter, "inside")
        enter()

    run(seed, program)


def test_a_thread_that_ends_is_not_left_so_that_it_can_be_joined() -> None:
    left = []

    def program(clock: VirtualClock) -> None:
        def end() -> None:
            clock.end_thread()
            steps = clock.time.recesses.steps
            for _ in range(50):
                clock.switch_point()
            left.append(clock.time.recesses.steps != steps)

        start_busy(clock, 2)
        for _ in range(5):
            clock.start_thread(end, "ending")
            clock.sleep(0)

    for seed in SEEDS:
        run(seed, program)
    assert left
    assert not any(left)
