"""Wall time that is paused, slowed down and sped up: what it shows, and whom it lets go when."""

import random
import sys
import threading
import time
from collections.abc import Callable, Iterator

import pytest

from sim.clock import PacedClock

MILLISECOND = 1_000_000
SECOND = 1_000_000_000
_PATIENCE = 60.0


@pytest.fixture
def clock() -> Iterator[PacedClock]:
    clock = PacedClock()
    yield clock
    clock.set_speed(1e6)
    clock.resume()


class Doing(threading.Thread):
    """Does something on a thread of its own, and tells when it is done."""

    def __init__(self, action: Callable[[], object]) -> None:
        super().__init__(daemon=True)
        self._action = action
        self.result: object = None
        self.error: BaseException | None = None
        self.start()

    def run(self) -> None:
        try:
            self.result = self._action()
        except BaseException as error:  # noqa: BLE001 -- the test asks for it
            self.error = error

    def stands(self) -> bool:
        """Whether it is still at it after a while."""
        self.join(0.03)
        return self.is_alive()

    def outcome(self) -> object:
        """What came of it."""
        self.join(_PATIENCE)
        assert not self.is_alive()
        return self.result


def until_it_waits(clock: PacedClock) -> None:
    """Wait until a thread waits on the clock."""
    while not clock._sleepers:
        time.sleep(0.001)


def test_a_clock_whose_pace_nobody_changes_shows_wall_time(clock: PacedClock) -> None:
    before = time.monotonic_ns() - clock.origin
    shown = clock.now()
    after = time.monotonic_ns() - clock.origin
    assert before <= shown <= after


def test_a_paused_clock_stands_and_goes_on_where_it_stood(clock: PacedClock) -> None:
    clock.pause()
    stood = clock.now()
    time.sleep(0.02)
    assert clock.now() == stood
    clock.resume()
    assert clock.now() >= stood
    assert clock.now() < time.monotonic_ns() - clock.origin - 19 * MILLISECOND


def test_pausing_twice_and_going_on_twice_is_doing_it_once(clock: PacedClock) -> None:
    clock.pause()
    clock.pause()
    stood = clock.now()
    clock.resume()
    clock.resume()
    clock.sleep(MILLISECOND)
    assert clock.now() >= stood + MILLISECOND


def test_a_sleep_that_began_before_a_pause_ends_after_it(clock: PacedClock) -> None:
    sleeper = Doing(lambda: clock.sleep(3600 * SECOND))
    until_it_waits(clock)
    clock.pause()
    clock.set_speed(1e6)
    assert sleeper.stands()
    clock.resume()
    sleeper.outcome()
    assert clock.now() >= 3600 * SECOND


def test_a_sleep_that_begins_in_a_pause_ends_after_it(clock: PacedClock) -> None:
    clock.pause()
    sleeper = Doing(lambda: clock.sleep(MILLISECOND))
    assert sleeper.stands()
    clock.resume()
    sleeper.outcome()


def test_a_sleep_is_as_much_longer_as_the_clock_is_slower() -> None:
    clock = PacedClock(speed=0.1)
    began = time.monotonic()
    clock.sleep(5 * MILLISECOND)
    assert time.monotonic() - began >= 0.05


def test_speeding_up_shortens_the_sleeps_that_go_on(clock: PacedClock) -> None:
    sleeper = Doing(lambda: clock.sleep(3600 * SECOND))
    until_it_waits(clock)
    clock.set_speed(1e6)
    sleeper.outcome()
    assert clock.now() >= 3600 * SECOND


def test_a_speed_given_in_a_pause_holds_after_it(clock: PacedClock) -> None:
    clock.pause()
    clock.set_speed(1e6)
    stood = clock.now()
    time.sleep(0.005)
    assert clock.now() == stood
    clock.resume()
    clock.sleep(3600 * SECOND)


def test_a_signal_is_heard_in_a_pause(clock: PacedClock) -> None:
    clock.pause()
    signal = clock.auto_reset_event()
    waiter = Doing(lambda: signal.wait(clock.now() + 1))
    until_it_waits(clock)
    assert waiter.stands()
    signal.set()
    assert waiter.outcome() is True


def test_a_change_of_pace_is_no_signal(clock: PacedClock) -> None:
    signal = clock.auto_reset_event()
    waiter = Doing(lambda: signal.wait(3600 * SECOND))
    until_it_waits(clock)
    for _ in range(5):
        clock.pause()
        clock.resume()
    assert waiter.stands()
    clock.set_speed(1e6)
    assert waiter.outcome() is False


def test_a_signal_set_before_the_wait_is_not_lost_and_a_wait_clears_it(clock: PacedClock) -> None:
    signal = clock.auto_reset_event()
    signal.set()
    signal.set()
    assert signal.wait(None)
    assert not signal.wait(clock.now() + MILLISECOND)


def test_many_threads_setting_one_signal_at_once_do_not_fail(clock: PacedClock) -> None:
    signal = clock.auto_reset_event()

    def set_often() -> None:
        for _ in range(200):
            signal.set()

    threads = [threading.Thread(target=set_often) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert signal.wait(0)
    assert not signal.wait(0)


def test_a_wait_whose_deadline_has_passed_returns_at_once(clock: PacedClock) -> None:
    assert not clock.auto_reset_event().wait(0)
    clock.pause()
    assert not clock.auto_reset_event().wait(0)


def test_an_action_is_done_once_its_time_has_come_on_this_clock(clock: PacedClock) -> None:
    signal = clock.auto_reset_event()
    moments: list[int] = []

    def act() -> None:
        moments.append(clock.now())
        signal.set()

    clock.pause()
    at = clock.now() + 5 * MILLISECOND
    clock.call_at(at, act)
    waiter = Doing(lambda: signal.wait(None))
    assert waiter.stands()
    clock.resume()
    assert waiter.outcome() is True
    assert moments[0] >= at


def test_an_interrupted_thread_wakes_from_its_sleep_even_in_a_pause(clock: PacedClock) -> None:
    clock.pause()
    sleeper = Doing(lambda: clock.sleep(SECOND))
    until_it_waits(clock)
    assert sleeper.stands()
    assert sleeper.ident is not None
    clock.interrupt(sleeper.ident)
    sleeper.outcome()
    assert isinstance(sleeper.error, KeyboardInterrupt)


@pytest.fixture
def threads_in_turn() -> Iterator[None]:
    """Interrupt threads that compute, a hundred times a millisecond, wherever they are."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(0.00001)
    yield
    sys.setswitchinterval(before)


@pytest.mark.usefixtures("threads_in_turn")
def test_time_never_goes_back_for_anybody_whatever_is_done_to_it(clock: PacedClock) -> None:
    over = threading.Event()

    def read() -> bool:
        last = 0
        while not over.is_set():
            now = clock.now()
            if now < last:
                return False
            last = now
        return True

    readers = [Doing(read) for _ in range(3)]
    chance = random.Random(1)
    for _ in range(300):
        change = chance.choice(["pause", "resume", "speed"])
        if change == "pause":
            clock.pause()
        elif change == "resume":
            clock.resume()
        else:
            clock.set_speed(chance.choice([0.1, 1.0, 20.0]))
        time.sleep(0.0002)
    over.set()
    assert [reader.outcome() for reader in readers] == [True, True, True]


def test_signals_are_neither_lost_nor_heard_twice_while_the_pace_changes(clock: PacedClock) -> None:
    """Two threads pass a ball; one that lost it would wait for ever."""
    there, back = clock.auto_reset_event(), clock.auto_reset_event()
    passes = 2000

    def answer() -> int:
        heard = 0
        for _ in range(passes):
            heard += there.wait(clock.now() + 3600 * SECOND)
            back.set()
        return heard

    def ask() -> int:
        heard = 0
        for _ in range(passes):
            there.set()
            heard += back.wait(clock.now() + 3600 * SECOND)
        return heard

    players = [Doing(answer), Doing(ask)]
    while any(player.is_alive() for player in players):
        clock.pause()
        clock.resume()
    assert [player.outcome() for player in players] == [passes, passes]
