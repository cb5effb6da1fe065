"""Python's own ways to wait, on a paced clock. They are replaced for good, so each program has a process."""

import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

_PRELUDE = """
import concurrent.futures, queue, threading, time
real_sleep, real_monotonic = time.sleep, time.monotonic
RealThread, real_join = threading.Thread, threading.Thread.join
from sim.clock.paced import PacedClock
from sim.clock.paced_stdlib import follow
clock = PacedClock()
follow(clock)
HOUR = 3600
def fast():
    clock.set_speed(1e6)
def stands_in_a_pause(action):
    "Whether an action with a timeout goes on in a pause, and comes to its end after it."
    clock.pause()
    done = []
    thread = RealThread(target=lambda: done.append(action()), daemon=True)
    thread.start()
    real_sleep(0.05)
    stood = not done
    clock.resume()
    real_join(thread, 60)
    return stood and len(done) == 1
"""


def run(program: str) -> None:
    """Run a program that lives on a paced clock; what it asserts must hold, and it must end."""
    ended = subprocess.run(
        [sys.executable, "-c", _PRELUDE + textwrap.dedent(program) + "\nprint('to the end')"],
        capture_output=True,
        text=True,
        cwd=Path(__file__).parents[2],
        check=False,
    )
    assert ended.stderr == ""
    assert ended.stdout == "to the end\n"


PROGRAMS = {
    "every_clock_stands_in_a_pause": """
        clock.pause()
        shown = [time.monotonic(), time.perf_counter(), time.time(), time.monotonic_ns(), time.time_ns()]
        real_sleep(0.01)
        assert shown == [
            time.monotonic(), time.perf_counter(), time.time(), time.monotonic_ns(), time.time_ns()
        ]
        assert shown[0] == shown[1] and shown[3] / 1e9 == shown[0]
    """,
    "clocks_that_nobody_paced_show_what_they_always_do": """
        before, shown, after = real_monotonic(), time.monotonic(), real_monotonic()
        assert before <= shown <= after
        assert time.time() - clock.epoch / 1e9 < 60
    """,
    "a_sleep_takes_paced_time": """
        assert stands_in_a_pause(lambda: time.sleep(0.001))
        fast()
        time.sleep(HOUR)
    """,
    "a_negative_sleep_is_a_value_error": """
        try:
            time.sleep(-1)
        except ValueError as error:
            assert str(error) == "sleep length must be non-negative"
        else:
            raise AssertionError
    """,
    "a_timeout_of_a_lock_takes_paced_time": """
        for lock in (threading.Lock(), threading.RLock()):
            lock.acquire()
            assert stands_in_a_pause(lambda: lock.acquire(timeout=0.01))
            fast()
            with concurrent.futures.ThreadPoolExecutor(1) as pool:
                assert not pool.submit(lock.acquire, timeout=HOUR).result()
                assert not pool.submit(lock.acquire, blocking=False).result()
            clock.set_speed(1)
    """,
    "locks_do_what_locks_do": """
        lock = threading.Lock()
        with lock:
            assert lock.locked()
        assert not lock.locked()
        assert lock.acquire(timeout=1)
        lock.release()
        recursive = threading.RLock()
        with recursive, recursive:
            assert recursive.acquire(timeout=1)
            recursive.release()
        try:
            lock.release()
        except RuntimeError:
            pass
        else:
            raise AssertionError
    """,
    "events_conditions_and_semaphores_time_out_in_paced_time": """
        assert stands_in_a_pause(lambda: threading.Event().wait(0.01))
        assert stands_in_a_pause(lambda: threading.Semaphore(0).acquire(timeout=0.01))
        fast()
        assert not threading.Event().wait(HOUR)
        condition = threading.Condition()
        with condition:
            assert not condition.wait(HOUR)
            assert not condition.wait_for(lambda: False, HOUR)
    """,
    "an_event_is_heard_in_a_pause": """
        event = threading.Event()
        clock.pause()
        threading.Thread(target=event.set).start()
        assert event.wait(HOUR)
    """,
    "queues_time_out_in_paced_time": """
        def nothing_comes(source, seconds):
            try:
                source.get(timeout=seconds)
            except queue.Empty:
                return True
        for source in (queue.Queue(), queue.SimpleQueue()):
            assert stands_in_a_pause(lambda: nothing_comes(source, 0.01))
            fast()
            assert nothing_comes(source, HOUR)
            clock.set_speed(1)
            source.put(1)
            assert source.get(timeout=1) == 1
    """,
    "threads_are_joined_and_timers_fire_in_paced_time": """
        sleeper = threading.Thread(target=time.sleep, args=(HOUR,), daemon=True)
        sleeper.start()
        assert stands_in_a_pause(lambda: sleeper.join(0.01))
        assert sleeper.is_alive()
        fired = threading.Event()
        threading.Timer(HOUR, fired.set).start()
        fast()
        sleeper.join()
        assert fired.wait(1e5 * HOUR)
    """,
    "futures_time_out_in_paced_time": """
        with concurrent.futures.ThreadPoolExecutor(1) as pool:
            assert pool.submit(lambda: 3).result(timeout=HOUR) == 3
            fast()
            slow = pool.submit(time.sleep, HOUR)
            try:
                slow.result(timeout=HOUR / 2)
            except concurrent.futures.TimeoutError:
                pass
    """,
}


@pytest.mark.parametrize("name", PROGRAMS)
def test(name: str) -> None:
    run(PROGRAMS[name])
