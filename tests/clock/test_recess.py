"""A moment whose threads go on and on has recesses: inputs and steering reach the run, in a fixed order."""

import threading
from collections.abc import Callable

from sim.clock import VirtualClock
from sim.clock.recesses import RECESS, WAITS_TO_RECESS
from tests.support.simulation import EndedClock, no_thread_left

PATIENCE = 60.0


def on_virtual_time(program: Callable[[VirtualClock], object]) -> None:
    """Run ``program`` as the main thread of a new clock, and end whatever it leaves."""
    with no_thread_left():
        clock = EndedClock()
        try:
            program(clock)
        finally:
            clock.wind_up()


def dawdle(clock: VirtualClock, until: Callable[[], object]) -> int:
    """Sleep no time until something is so; returns how often."""
    count = 0
    while not until():
        clock.sleep(0)
        count += 1
    return count


def test_an_input_reaches_a_loop_that_sleeps_no_time() -> None:
    done: list[int] = []

    def program(clock: VirtualClock) -> None:
        clock.time.give(lambda: done.append(clock.time.recesses.current))
        assert dawdle(clock, lambda: done) == WAITS_TO_RECESS
        assert clock.now() == RECESS

    on_virtual_time(program)
    assert done == [1]


def test_every_recess_takes_one_input_so_that_its_effects_come_first() -> None:
    done: list[int] = []

    def program(clock: VirtualClock) -> None:
        for _ in range(3):
            clock.time.give(lambda: done.append(clock.time.recesses.current))
        dawdle(clock, lambda: len(done) == 3)

    on_virtual_time(program)
    assert done == [1, 2, 3]


def test_an_input_is_repeated_in_its_recess_and_one_of_the_end_comes_at_the_end() -> None:
    done: list[tuple[str, int, int]] = []
    end = 5 + 4 * RECESS

    def program(clock: VirtualClock) -> None:
        def note(name: str) -> Callable[[], None]:
            return lambda: done.append((name, clock.now(), clock.time.recesses.current))

        clock.time.schedule_input(5 + 2 * RECESS, note("third"), 3)
        clock.time.schedule_input(end, note("end"))
        clock.time.schedule_input(end + 2, note("first"), 1)
        clock.sleep(5)
        for _ in range(WAITS_TO_RECESS * 4):
            clock.sleep(0)
        clock.sleep(2)
        dawdle(clock, lambda: len(done) == 3)

    on_virtual_time(program)
    assert done == [("third", 5 + 2 * RECESS, 3), ("end", end, 0), ("first", end + 2, 1)]


def test_threads_that_wake_each_other_for_ever_have_recesses_too() -> None:
    done: list[int] = []

    def program(clock: VirtualClock) -> None:
        signals = clock.auto_reset_event(), clock.auto_reset_event()

        def answer() -> None:
            while True:
                signals[0].wait(None)
                signals[1].set()

        clock.start_thread(answer, "answer")
        clock.time.give(lambda: done.append(clock.time.recesses.current))
        while not done:
            signals[0].set()
            signals[1].wait(None)

    on_virtual_time(program)
    assert done == [1]


def test_a_recess_of_waits_for_no_time_lasts_until_the_next_deadline_at_most() -> None:
    def program(clock: VirtualClock) -> None:
        woken: list[int] = []
        clock.call_at(RECESS // 4, lambda: woken.append(clock.now()))
        dawdle(clock, lambda: woken)
        assert woken == [RECESS // 4]

    on_virtual_time(program)


def test_time_stands_for_threads_that_hand_something_on() -> None:
    def program(clock: VirtualClock) -> None:
        signals = clock.auto_reset_event(), clock.auto_reset_event()

        def answer() -> None:
            for _ in range(2 * WAITS_TO_RECESS):
                signals[0].wait(None)
                signals[1].set()

        clock.start_thread(answer, "answer")
        for _ in range(2 * WAITS_TO_RECESS):
            signals[0].set()
            signals[1].wait(None)
        assert clock.now() == 0

    on_virtual_time(program)


def test_time_that_passes_begins_the_count_anew() -> None:
    recesses: list[int] = []

    def program(clock: VirtualClock) -> None:
        clock.time.on_recess = recesses.append
        for _ in range(5):
            for _ in range(WAITS_TO_RECESS - 2):
                clock.sleep(0)
            clock.sleep(1)
        assert recesses == []
        for _ in range(2 * WAITS_TO_RECESS):
            clock.sleep(0)

    on_virtual_time(program)
    assert recesses == [1, 2]


def test_what_waits_is_explained_in_a_recess() -> None:
    looks: list[int] = []

    def program(clock: VirtualClock) -> None:
        clock.time.before_jump = lambda: looks.append(clock.time.recesses.current)
        for _ in range(WAITS_TO_RECESS):
            clock.sleep(0)

    on_virtual_time(program)
    assert looks == [1]


def test_a_loop_that_sleeps_no_time_can_be_paused_given_an_input_and_resumed() -> None:
    done: list[str] = []
    stands = threading.Event()
    turns = [0]

    def outside(clock: VirtualClock) -> None:
        clock.time.steer(clock.time.pause)
        while not clock.time.rests:
            stands.wait(0.001)
        before = turns[0]
        stands.wait(0.02)
        done.append("stood" if turns[0] == before else "ran")
        clock.time.give(lambda: done.append("input"))
        while "input" not in done:
            stands.wait(0.001)
        clock.time.steer(clock.time.resume)
        clock.time.steer(lambda: done.append("resumed"))

    def program(clock: VirtualClock) -> None:
        helper = threading.Thread(target=lambda: outside(clock), daemon=True)
        helper.start()
        while "resumed" not in done:
            turns[0] += 1
            clock.sleep(0)
        helper.join(PATIENCE)

    on_virtual_time(program)
    assert done == ["stood", "input", "resumed"]


def test_a_step_in_a_moment_without_decisions_ends_in_its_recess() -> None:
    halts: list[int] = []
    over: list[bool] = []

    def program(clock: VirtualClock) -> None:
        def halted() -> None:
            halts.append(clock.time.recesses.current)
            if len(halts) == 2:
                over.append(True)
                clock.time.resume()

        clock.time.pace.on_halt = halted
        clock.time.step()
        clock.time.step()
        dawdle(clock, lambda: over)

    on_virtual_time(program)
    assert halts == [1, 2]
