"""Wall time: the same interface on the machine's own clock and threads."""

import threading

from sim.clock import RealClock

MILLISECOND = 1_000_000


def test_a_sleep_takes_at_least_its_time() -> None:
    clock = RealClock()
    before = clock.now()
    clock.sleep(5 * MILLISECOND)
    assert clock.now() - before >= 5 * MILLISECOND


def test_a_signal_set_before_the_wait_is_not_lost_and_a_wait_clears_it() -> None:
    clock = RealClock()
    signal = clock.signal()
    signal.set()
    signal.set()
    assert signal.wait(None)
    assert not signal.wait(clock.now() + MILLISECOND)


def test_a_wait_whose_deadline_has_passed_returns_at_once() -> None:
    assert not RealClock().signal().wait(0)


def test_a_thread_wakes_another_by_its_signal() -> None:
    clock = RealClock()
    signal = clock.signal()
    names: list[str] = []

    def other() -> None:
        names.append(threading.current_thread().name)
        signal.set()

    clock.start_thread(other, "other")
    assert signal.wait(None)
    assert names == ["other"]


def test_an_action_runs_once_its_time_has_come() -> None:
    clock = RealClock()
    signal = clock.signal()
    moments: list[int] = []

    def act() -> None:
        moments.append(clock.now())
        signal.set()

    clock.call_at(5 * MILLISECOND, act)
    assert signal.wait(None)
    assert moments[0] >= 5 * MILLISECOND


def test_many_threads_setting_one_signal_at_once_do_not_fail() -> None:
    clock = RealClock()
    signal = clock.signal()

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
