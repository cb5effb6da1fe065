"""Where threads of a virtual clock switch that explores orders. Each program has a process of its own."""

import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

from tests.support.daily import first_daily

_PRELUDE = """
import queue, sys, threading, time
import concurrent.futures.thread as futures
from sim.clock import VirtualClock
from sim.clock.lock_cycles import cycle_of
from sim.clock.strategies import schedule_of
from sim.clock.stdlib import live_on
clock = VirtualClock(schedule=schedule_of(int(sys.argv[1])))
live_on(clock)
def at_once(*targets):
    threads = [threading.Thread(target=target) for target in targets]
    for each in threads:
        each.start()
    for each in threads:
        each.join()
"""

PROGRAMS = {
    "pools_that_were_imported_before_the_run_do_not_hold_each_other_up": """
        def work():
            with futures.ThreadPoolExecutor(2) as pool:
                assert list(pool.map(abs, [-1, -2])) == [1, 2]
        at_once(work, work, work)
    """,
    "threads_that_import_the_same_module_do_not_hold_each_other_up": """
        import pathlib, tempfile
        folder = tempfile.mkdtemp()
        pathlib.Path(folder, "asks_often.py").write_text("import time\\nfor _ in range(50): time.time()")
        sys.path.insert(0, folder)
        def load():
            import asks_often
        at_once(load, load, load)
    """,
    "an_update_gets_lost_in_some_rounds_and_not_in_others": """
        def round():
            global count
            count = 0
            def add():
                global count
                seen = count
                time.monotonic()
                count = seen + 1
            at_once(add, add)
            return count
        assert {round() for _ in range(300)} == {1, 2}
    """,
    "no_update_gets_lost_under_a_lock": """
        lock, count = threading.Lock(), 0
        def add():
            global count
            for _ in range(100):
                with lock:
                    seen = count
                    time.monotonic()
                    count = seen + 1
        at_once(add, add, add)
        assert count == 300
    """,
    "any_of_those_that_wait_gets_a_lock": """
        def round():
            lock, order = threading.Lock(), []
            def come(name):
                with lock:
                    order.append(name)
            def hold():
                with lock:
                    time.sleep(1)
            at_once(hold, lambda: come('a'), lambda: come('b'))
            return tuple(order)
        assert {round() for _ in range(100)} == {('a', 'b'), ('b', 'a')}
    """,
    "who_let_go_of_a_lock_may_take_it_before_those_that_wait": """
        def round():
            lock, order = threading.Lock(), []
            def twice():
                for _ in range(2):
                    with lock:
                        time.sleep(1)
                        order.append('twice')
            def once():
                time.sleep(0.5)
                with lock:
                    order.append('once')
            at_once(twice, once)
            return order.index('once')
        assert {round() for _ in range(200)} == {1, 2}
    """,
    "a_queue_keeps_its_order_and_loses_nothing": """
        line, got = queue.Queue(2), []
        def put():
            for number in range(200):
                line.put(number)
        def get():
            for _ in range(200):
                got.append(line.get())
        at_once(put, get)
        assert got == list(range(200))
    """,
    "whoever_is_notified_wakes": """
        condition, waiting, woken = threading.Condition(), 0, 0
        def wait():
            global waiting, woken
            with condition:
                waiting += 1
                condition.wait()
                woken += 1
        def notify():
            while waiting < 5:
                time.sleep(0.1)
            for _ in range(5):
                with condition:
                    condition.notify()
        at_once(notify, *[wait] * 5)
        assert woken == 5
    """,
    "a_wait_for_a_lock_ends_in_time": """
        lock, late = threading.Lock(), []
        def hold():
            while clock.now() < 5_000_000_000:
                with lock:
                    time.sleep(0.3)
        def try_it():
            for _ in range(20):
                began = time.monotonic()
                if lock.acquire(timeout=0.1):
                    lock.release()
                late.append(time.monotonic() - began)
                time.sleep(0.05)
        at_once(hold, hold, try_it)
        assert max(late) <= 0.1 + 1e-9
    """,
    "one_who_is_interrupted_on_the_way_to_a_lock_leaves_it_to_the_next": """
        def round():
            lock, ends, got = threading.Lock(), [], []
            def come():
                ends.append(threading.get_ident())
                try:
                    with lock:
                        got.append(True)
                except KeyboardInterrupt:
                    pass
            def hold():
                with lock:
                    time.sleep(1)
                clock.interrupt(ends[0])
            at_once(hold, come, come)
            return len(got)
        assert {round() for _ in range(200)} <= {1, 2}
    """,
    "threads_that_wait_for_each_others_locks_are_noticed": """
        one, two, found = threading.RLock(), threading.Lock(), []
        clock.on_lock_wait = lambda thread: found.append([each.name for each in cycle_of(thread)])
        def take(first, second):
            with first:
                time.sleep(1)
                second.acquire(timeout=5) if second is one else second.acquire()
        def forth():
            with one:
                time.sleep(1)
                two.acquire()
        def back():
            with two:
                time.sleep(1.5)
                one.acquire()
        for target in (forth, back):
            threading.Thread(target=target, name=target.__name__, daemon=True).start()
        time.sleep(3)
        assert found == [[], ['back', 'forth']], found
    """,
    "a_condition_or_a_lock_as_a_signal_is_no_circle": """
        found = []
        clock.on_lock_wait = lambda thread: found.append(cycle_of(thread))
        signal, event = threading.Lock(), threading.Event()
        signal.acquire()
        def give():
            time.sleep(1)
            signal.release()
            event.set()
        threading.Thread(target=give).start()
        signal.acquire()
        event.wait()
        assert found
        assert not any(found)
    """,
}


@pytest.mark.parametrize("seed", first_daily(1, 3))
def test_programs_in_another_order(seed: int) -> None:
    """Each lives in a process of its own, for which time is replaced for good."""
    for name, program in PROGRAMS.items():
        ended = subprocess.run(
            [sys.executable, "-c", _PRELUDE + textwrap.dedent(program) + "\nprint('to the end')", str(seed)],
            capture_output=True,
            text=True,
            cwd=Path(__file__).parents[2],
            check=False,
        )
        assert (ended.stderr, ended.stdout) == ("", "to the end\n"), name
