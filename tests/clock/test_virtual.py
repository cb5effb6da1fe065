"""Virtual time: one thread at a time, and jumps to the earliest deadline when none can run."""

import threading
from collections.abc import Callable

from sim.clock import VirtualClock
from sim.clock.schedule import Schedule
from tests.support.simulation import EndedClock, no_thread_left

SECOND = 1_000_000_000


def on_virtual_time(program: Callable[[VirtualClock], object]) -> None:
    """Run ``program`` as the main thread of a new clock, and end whatever it leaves."""
    with no_thread_left():
        clock = EndedClock()
        try:
            program(clock)
        finally:
            clock.wind_up()


def test_sleeping_takes_exactly_its_time_and_computing_takes_none() -> None:
    def program(clock: VirtualClock) -> None:
        clock.sleep(3 * SECOND)
        assert clock.now() == 3 * SECOND
        sum(range(10_000))
        assert clock.now() == 3 * SECOND

    on_virtual_time(program)


def test_on_a_late_machine_waits_end_late_and_those_of_no_time_do_not() -> None:
    class Late(Schedule):
        def lateness(self) -> int:
            return 7

    with no_thread_left():
        clock = EndedClock(schedule=Late())
        ends = []
        for duration in (3 * SECOND, 0):
            clock.sleep(duration)
            ends.append(clock.now())
        assert not clock.auto_reset_event().wait(4 * SECOND)
        assert [*ends, clock.now()] == [3 * SECOND + 7, 3 * SECOND + 7, 4 * SECOND + 7]
        clock.wind_up()


def test_a_negative_sleep_takes_no_time() -> None:
    def program(clock: VirtualClock) -> None:
        clock.sleep(-SECOND)
        assert clock.now() == 0

    on_virtual_time(program)


def test_sleeping_for_no_time_lets_every_thread_that_can_run_go_first() -> None:
    said: list[str] = []

    def program(clock: VirtualClock) -> None:
        for name in "abc":
            clock.start_thread(lambda name=name: said.append(name), name)  # type: ignore[misc]
        said.append("main")
        clock.sleep(0)
        said.append("main again")

    on_virtual_time(program)
    assert said == ["main", "a", "b", "c", "main again"]


def test_threads_with_one_deadline_go_on_in_the_order_in_which_they_went_to_sleep() -> None:
    woken: list[str] = []

    def program(clock: VirtualClock) -> None:
        def sleeper(name: str, first: int) -> None:
            clock.sleep(first)
            clock.sleep(SECOND - first)
            woken.append(name)

        for name, first in (("late", 300), ("early", 100), ("middle", 200)):
            clock.start_thread(lambda name=name, first=first: sleeper(name, first), name)  # type: ignore[misc]
        clock.sleep(2 * SECOND)

    on_virtual_time(program)
    assert woken == ["early", "middle", "late"]


def test_a_signal_set_before_the_wait_is_not_lost_and_a_wait_clears_it() -> None:
    def program(clock: VirtualClock) -> None:
        signal = clock.auto_reset_event()
        signal.set()
        signal.set()
        assert signal.wait(SECOND)
        assert clock.now() == 0
        assert not signal.wait(SECOND)
        assert clock.now() == SECOND

    on_virtual_time(program)


def test_a_wait_whose_deadline_has_passed_returns_at_once() -> None:
    def program(clock: VirtualClock) -> None:
        clock.sleep(SECOND)
        assert not clock.auto_reset_event().wait(SECOND)
        assert not clock.auto_reset_event().wait(0)
        assert clock.now() == SECOND

    on_virtual_time(program)


def test_a_signal_ends_a_wait_before_its_deadline_and_the_old_deadline_wakes_nobody_later() -> None:
    def program(clock: VirtualClock) -> None:
        signal = clock.auto_reset_event()
        clock.call_at(SECOND, signal.set)
        assert signal.wait(2 * SECOND)
        assert clock.now() == SECOND
        clock.sleep(4 * SECOND)
        assert clock.now() == 5 * SECOND

    on_virtual_time(program)


def test_actions_run_at_their_time_in_the_order_of_being_asked_for() -> None:
    done: list[tuple[str, int]] = []

    def program(clock: VirtualClock) -> None:
        for name, time in (("c", 2), ("a", 1), ("d", 2), ("b", 1)):
            clock.call_at(time * SECOND, lambda name=name: done.append((name, clock.now())))  # type: ignore[misc]
        clock.sleep(3 * SECOND)

    on_virtual_time(program)
    assert done == [("a", SECOND), ("b", SECOND), ("c", 2 * SECOND), ("d", 2 * SECOND)]


def test_an_action_asked_for_in_the_past_runs_now() -> None:
    done: list[int] = []

    def program(clock: VirtualClock) -> None:
        clock.sleep(SECOND)
        clock.call_at(0, lambda: done.append(clock.now()))
        clock.sleep(SECOND)

    on_virtual_time(program)
    assert done == [SECOND]


def test_before_each_jump_of_time_the_hook_is_called_once_at_the_old_time() -> None:
    seen: list[int] = []

    def program(clock: VirtualClock) -> None:
        def look() -> None:
            seen.append(clock.now())

        clock.time.before_jump = look
        clock.sleep(SECOND)
        clock.sleep(0)
        clock.sleep(SECOND)

    on_virtual_time(program)
    assert seen[:2] == [0, SECOND]
    assert len(seen) == 2


def test_time_stops_over_where_the_hook_asks_for_it() -> None:
    seen: list[int] = []

    def program(clock: VirtualClock) -> None:
        def look() -> int:
            seen.append(clock.now())
            return 3 * SECOND

        clock.time.before_jump = look
        clock.sleep(2 * SECOND)
        clock.sleep(3 * SECOND)
        assert clock.now() == 5 * SECOND

    on_virtual_time(program)
    assert seen == [0, 2 * SECOND, 3 * SECOND]


def test_an_interrupt_is_raised_once_out_of_the_wait_of_the_thread_that_it_is_for() -> None:
    raised: list[int] = []

    def program(clock: VirtualClock) -> None:
        def other() -> None:
            try:
                clock.sleep(10 * SECOND)
            except KeyboardInterrupt:
                raised.append(clock.now())
            clock.sleep(SECOND)
            raised.append(clock.now())

        clock.start_thread(other, "other")
        clock.sleep(0)
        (sleeper,) = clock.threads - {clock.current}
        clock.call_at(SECOND, lambda: clock.interrupt(sleeper.ident))
        clock.sleep(10 * SECOND)
        assert clock.now() == 10 * SECOND

    on_virtual_time(program)
    assert raised == [SECOND, 2 * SECOND]


def test_an_interrupt_passes_what_catches_exceptions() -> None:
    def program(clock: VirtualClock) -> None:
        def stubborn() -> None:
            while True:
                try:
                    clock.sleep(SECOND)
                except Exception:  # noqa: BLE001 -- what a careless callback does
                    continue

        clock.start_thread(stubborn, "stubborn")
        clock.sleep(3 * SECOND)

    on_virtual_time(program)


def test_an_interrupt_ends_a_wait_for_a_signal_that_nobody_sets() -> None:
    def program(clock: VirtualClock) -> None:
        for _ in range(3):
            signal = clock.auto_reset_event()
            clock.start_thread(lambda signal=signal: signal.wait(None), "waiter")  # type: ignore[misc]
        clock.sleep(SECOND)

    on_virtual_time(program)


def test_only_the_thread_that_has_the_baton_lives_on_the_clock() -> None:
    answers: dict[str, bool] = {}

    def program(clock: VirtualClock) -> None:
        stranger = threading.Thread(target=lambda: answers.update(stranger=clock.owns_current_thread()))
        stranger.start()
        stranger.join()
        clock.start_thread(lambda: answers.update(member=clock.owns_current_thread()), "member")
        clock.sleep(SECOND)
        answers["main"] = clock.owns_current_thread()

    on_virtual_time(program)
    assert answers == {"stranger": False, "member": True, "main": True}


def test_every_wait_counts_as_a_step() -> None:
    def program(clock: VirtualClock) -> None:
        before = clock.time.recesses.steps
        clock.sleep(SECOND)
        clock.sleep(SECOND)
        assert clock.time.recesses.steps == before + 2

    on_virtual_time(program)
