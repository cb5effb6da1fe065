"""A paced run keeps step with the wall, can be paused and hurried, and takes orders from outside."""

import threading
import time
from collections.abc import Callable

from sim.clock import VirtualClock
from tests.support.simulation import EndedClock, no_thread_left

SECOND = 1_000_000_000


def paced(speed: float | None, program: Callable[[VirtualClock], object]) -> float:
    """Run ``program`` at a speed; how many real seconds it took."""
    with no_thread_left():
        began = time.monotonic()
        clock = EndedClock(speed)
        program(clock)
        took = time.monotonic() - began
        clock.wind_up()
    return took


def outside(action: Callable[[], object]) -> threading.Thread:
    """Do ``action`` on a thread that does not live on the clock."""
    thread = threading.Thread(target=action, daemon=True)
    thread.start()
    return thread


def test_a_jump_takes_as_long_as_the_pace_says() -> None:
    assert paced(10.0, lambda clock: clock.sleep(SECOND)) >= 0.1


def test_without_a_pace_an_hour_passes_at_once() -> None:
    assert paced(None, lambda clock: clock.sleep(3600 * SECOND)) < 60


def test_what_is_injected_into_a_paced_run_happens_between_its_jumps() -> None:
    happened: list[int] = []

    def program(clock: VirtualClock) -> None:
        def act() -> None:
            happened.append(clock.now())
            clock.time.set_speed(None)

        outside(lambda: clock.time.inject(act))
        clock.sleep(3600 * SECOND)

    paced(1.0, program)
    (at,) = happened
    assert 0 <= at < 3600 * SECOND


def test_what_is_injected_wakes_a_run_in_which_nobody_sleeps() -> None:
    def program(clock: VirtualClock) -> None:
        signal = clock.auto_reset_event()
        outside(lambda: clock.time.inject(signal.set))
        assert signal.wait(None)

    paced(None, program)


def test_injected_actions_happen_in_the_order_of_injecting() -> None:
    happened: list[int] = []

    def program(clock: VirtualClock) -> None:
        signal = clock.auto_reset_event()

        def orders() -> None:
            for number in range(20):
                clock.time.inject(lambda number=number: happened.append(number))  # type: ignore[misc]
            clock.time.inject(signal.set)

        outside(orders)
        assert signal.wait(None)

    paced(None, program)
    assert happened == list(range(20))


def test_time_stands_while_paused_and_goes_on_where_it_stood() -> None:
    moments: list[int] = []

    def program(clock: VirtualClock) -> None:
        def orders() -> None:
            clock.time.inject(clock.time.pause)
            clock.time.inject(lambda: moments.append(clock.now()))
            time.sleep(0.1)
            clock.time.inject(lambda: moments.append(clock.now()))
            clock.time.inject(clock.time.resume)
            clock.time.inject(lambda: clock.time.set_speed(None))

        outside(orders)
        clock.sleep(3600 * SECOND)
        moments.append(clock.now())

    paced(10.0, program)
    paused, still, end = moments
    assert paused == still
    assert end == 3600 * SECOND


def test_a_new_speed_holds_from_the_moment_that_the_run_has_reached() -> None:
    def program(clock: VirtualClock) -> None:
        outside(lambda: clock.time.inject(lambda: clock.time.set_speed(None)))
        clock.sleep(3600 * SECOND)
        assert clock.now() == 3600 * SECOND

    assert paced(1.0, program) < 60


def test_a_run_at_rest_says_so() -> None:
    rested: list[bool] = []

    def program(clock: VirtualClock) -> None:
        signal = clock.auto_reset_event()

        def watch() -> None:
            while not clock.time.rests:
                time.sleep(0.001)
            rested.append(True)
            clock.time.inject(signal.set)

        outside(watch)
        signal.wait(None)
        assert not clock.time.rests

    paced(1.0, program)
    assert rested == [True]


def test_an_interrupt_from_outside_reaches_a_run_that_waits_for_its_pace() -> None:
    def program(clock: VirtualClock) -> None:
        main = clock.current.ident
        outside(lambda: clock.interrupt(main))
        try:
            clock.sleep(3600 * SECOND)
        except KeyboardInterrupt:
            return
        raise AssertionError("the run went on")

    assert paced(1.0, program) < 60
