"""Python's own ways to wait, on virtual time. They are replaced for good, so each program has a process."""

import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

_PRELUDE = """
import concurrent.futures, contextlib, queue, threading, time
real_sleep, real_monotonic = time.sleep, time.monotonic
orders = queue.SimpleQueue()
def outsider():
    while True:
        orders.get()()
threading.Thread(target=outsider, daemon=True).start()
from sim.clock import VirtualClock
from sim.clock.stdlib import live_on
clock = VirtualClock()
live_on(clock)
def now():
    return clock.now() / 1e9
def thread(target, *args):
    started = threading.Thread(target=target, args=args)
    started.start()
    return started
def after(seconds, action):
    def run():
        time.sleep(seconds)
        action()
    return thread(run)
"""


def run(program: str) -> None:
    """Run a program that lives on a virtual clock; what it asserts must hold, and it must end."""
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
    "other_threads_go_on_at_their_moments_while_a_process_runs": """
        import subprocess
        ticks = []
        def tick():
            for _ in range(3):
                time.sleep(0.1)
                ticks.append(time.monotonic())
        ticking = thread(tick)
        began = real_monotonic()
        subprocess.run(["sleep", "0.35"])
        assert ticks == [0.1, 0.2, 0.3] and 0.3 <= now() <= real_monotonic() - began + 0.5, (ticks, now())
    """,
    "time_jumps_again_once_a_process_has_ended": """
        import subprocess
        process = subprocess.Popen(["sleep", "0.2"])
        began = real_monotonic()
        time.sleep(3600)
        assert real_monotonic() - began < 60 and process.poll() == 0
    """,
    "looking_for_a_process_again_and_again_comes_to_its_end": """
        import subprocess
        began = real_monotonic()
        process = subprocess.Popen(["sleep", "1"])
        while process.poll() is None:
            pass
        assert 0.15 < now() <= real_monotonic() - began + 0.5, now()
    """,
    "a_handler_that_raises_ends_the_wait_that_its_alarm_rang_in": """
        import signal
        def late(*_):
            raise TimeoutError("too late")
        signal.signal(signal.SIGALRM, late)
        for wait in (threading.Event().wait, lambda: time.sleep(9), queue.Queue().get):
            signal.alarm(2)
            began = now()
            try:
                wait()
            except TimeoutError:
                assert now() == began + 2
                continue
            raise AssertionError
    """,
    "a_handler_that_sleeps_does_not_lengthen_a_sleep_nor_lose_a_wake_up": """
        import signal
        signal.signal(signal.SIGALRM, lambda *_: time.sleep(1))
        signal.alarm(2)
        time.sleep(5)
        assert now() == 5
        event = threading.Event()
        after(2.5, event.set)
        signal.alarm(2)
        assert event.wait(60) and now() == 8, now()
    """,
    "an_alarm_is_set_anew_and_told_of": """
        import signal
        rings = []
        signal.signal(signal.SIGALRM, lambda *_: rings.append(now()))
        assert signal.alarm(5) == 0
        time.sleep(1.5)
        assert signal.alarm(10) == 4
        assert signal.setitimer(signal.ITIMER_REAL, 0.5, 2) == (10, 0)
        time.sleep(5)
        assert signal.setitimer(signal.ITIMER_REAL, 0) == (1.5, 2)
        time.sleep(5)
        assert rings == [2, 4, 6], rings
    """,
    "a_signal_to_itself_interrupts_the_main_thread": """
        import os, signal
        after(0.5, lambda: os.kill(os.getpid(), signal.SIGINT))
        try:
            time.sleep(9)
        except KeyboardInterrupt:
            assert now() == 0.5
        else:
            raise AssertionError
    """,
    "a_signal_from_outside_is_handled_in_the_main_threads_turn": """
        import signal, subprocess, os
        came = []
        def handle(number, _):
            assert clock.current.is_main
            came.append(number)
        signal.signal(signal.SIGUSR2, handle)
        subprocess.run(["sh", "-c", f"kill -USR2 {os.getpid()}; sleep 0.2"])
        time.sleep(0)
        assert came == [signal.SIGUSR2]
    """,
    "a_blocked_alarm_waits_until_it_is_let_through": """
        import signal
        rings = []
        signal.signal(signal.SIGALRM, lambda *_: rings.append(now()))
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGALRM})
        signal.alarm(1)
        time.sleep(2)
        assert rings == [] and signal.sigpending() == {signal.SIGALRM}
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGALRM})
        time.sleep(1)
        assert len(rings) == 1
    """,
    "threads_outside_the_clock_keep_real_dates_and_real_randomness": """
        import datetime, os
        got, done = [], threading.Event()
        def ask():
            got.extend([datetime.datetime.now().year, time.localtime().tm_year, os.urandom(8)])
            clock.time.inject(done.set)
        orders.put(ask)
        done.wait()
        assert got[0] > 2024 and got[1] > 2024
        assert datetime.datetime.now().year == time.localtime().tm_year == 2023
    """,
    "a_date_is_pickled_compared_and_subclassed_as_ever": """
        import datetime, pickle
        from datetime import datetime as imported
        class Own(imported):
            pass
        told = imported.now()
        assert type(told) is imported is datetime.datetime
        assert pickle.loads(pickle.dumps(told)) == told == imported.fromtimestamp(time.time())
        assert isinstance(Own.now(datetime.UTC), Own) and Own.now(datetime.UTC).tzinfo
        time.sleep(1.5)
        assert imported.now() - told == datetime.timedelta(seconds=1.5)
    """,
    "a_lock_handed_to_one_who_is_interrupted_goes_to_the_next": """
        lock, ends, got = threading.Lock(), [], []
        def come():
            ends.append(threading.get_ident())
            with contextlib.suppress(KeyboardInterrupt), lock:
                got.append(threading.get_ident())
        lock.acquire()
        threads = [thread(come), thread(come)]
        time.sleep(1)
        lock.release()
        clock.interrupt(ends[0])
        for each in threads:
            each.join()
        assert got == ends[1:]
    """,
    "sleep_and_every_clock_show_virtual_time": """
        epoch = clock.epoch
        time.sleep(3600.5)
        assert time.monotonic() == time.perf_counter() == 3600.5
        assert time.monotonic_ns() == time.perf_counter_ns() == 3_600_500_000_000
        assert time.time_ns() == epoch + 3_600_500_000_000
        assert time.time() == (epoch + 3_600_500_000_000) / 1e9
    """,
    "a_negative_sleep_is_a_value_error": """
        try:
            time.sleep(-0.1)
        except ValueError as error:
            assert str(error) == "sleep length must be non-negative"
        else:
            raise AssertionError
    """,
    "a_lock_goes_to_those_who_wait_in_the_order_of_their_coming": """
        lock, order = threading.Lock(), []
        def hold(name, seconds):
            time.sleep(seconds)
            with lock:
                order.append((name, now()))
                time.sleep(10)
        threads = [thread(hold, name, at) for name, at in (("c", 3), ("a", 1), ("b", 2))]
        for each in threads:
            each.join()
        assert order == [("a", 1), ("b", 11), ("c", 21)], order
    """,
    "a_lock_is_given_up_for_after_its_timeout": """
        lock = threading.Lock()
        lock.acquire()
        assert not lock.acquire(timeout=2.5) and now() == 2.5
        assert not lock.acquire(blocking=False) and now() == 2.5
        after(1, lock.release)
        assert lock.acquire(timeout=5) and now() == 3.5
        lock.release()
        assert not lock.locked()
    """,
    "a_lock_refuses_what_pythons_refuses": """
        lock = threading.Lock()
        for wrong, error in ((lock.release, RuntimeError), (lambda: lock.acquire(False, 1), ValueError)):
            try:
                wrong()
            except error:
                lock.acquire(blocking=False)
            else:
                raise AssertionError(wrong)
    """,
    "an_rlock_lets_its_owner_in_again": """
        lock = threading.RLock()
        with lock, lock:
            waiter = after(1, lambda: lock.acquire() and lock.release())
            time.sleep(5)
            assert waiter.is_alive()
        waiter.join()
        assert now() == 5
    """,
    "a_condition_wakes_by_notify_and_by_timeout": """
        condition, box = threading.Condition(), []
        def put():
            with condition:
                box.append(1)
                condition.notify_all()
        after(2, put)
        with condition:
            assert condition.wait_for(lambda: box, timeout=10) and now() == 2
            assert not condition.wait(timeout=1.5) and now() == 3.5
    """,
    "an_event_wakes_all_who_wait_and_times_out": """
        event, woken = threading.Event(), []
        assert not event.wait(0.25) and now() == 0.25
        threads = [thread(lambda: woken.append((event.wait(), now()))) for _ in range(3)]
        time.sleep(1)
        event.set()
        for each in threads:
            each.join()
        assert woken == [(True, 1.25)] * 3, woken
    """,
    "a_semaphore_lets_in_as_many_as_it_counts": """
        gate, times = threading.Semaphore(2), []
        def work():
            with gate:
                times.append(now())
                time.sleep(1)
        for each in [thread(work) for _ in range(6)]:
            each.join()
        assert times == [0, 0, 1, 1, 2, 2], times
        assert gate.acquire(timeout=1) and gate.acquire() and not gate.acquire(timeout=1)
        assert now() == 4
    """,
    "a_barrier_opens_when_the_last_comes": """
        barrier, times = threading.Barrier(3), []
        def come(seconds):
            time.sleep(seconds)
            barrier.wait()
            times.append(now())
        for each in [thread(come, seconds) for seconds in (1, 5, 3)]:
            each.join()
        assert times == [5, 5, 5]
    """,
    "a_barrier_breaks_after_its_timeout": """
        barrier = threading.Barrier(2)
        try:
            barrier.wait(timeout=1.5)
        except threading.BrokenBarrierError:
            assert now() == 1.5
        else:
            raise AssertionError
    """,
    "a_timer_fires_at_its_time_and_can_be_cancelled": """
        fired = []
        kept = threading.Timer(2, lambda: fired.append(now()))
        cancelled = threading.Timer(1, lambda: fired.append("cancelled"))
        kept.start(), cancelled.start()
        cancelled.cancel()
        time.sleep(5)
        assert fired == [2], fired
    """,
    "a_queue_hands_over_and_times_out": """
        box = queue.Queue(maxsize=1)
        try:
            box.get(timeout=1.5)
        except queue.Empty:
            assert now() == 1.5
        after(1, lambda: box.put("a"))
        assert box.get() == "a" and now() == 2.5
        box.put("b")
        try:
            box.put("c", timeout=0.5)
        except queue.Full:
            assert now() == 3.0
        after(1, box.get)
        box.put("c")
        assert now() == 4.0
    """,
    "a_simple_queue_hands_over_and_times_out": """
        box = queue.SimpleQueue()
        try:
            box.get(timeout=1)
        except queue.Empty:
            assert now() == 1
        after(1, lambda: box.put("a"))
        assert box.get() == "a" and now() == 2
    """,
    "queue_join_waits_for_the_work_to_be_done": """
        box = queue.Queue()
        def work():
            while True:
                time.sleep(box.get())
                box.task_done()
        threading.Thread(target=work, daemon=True).start()
        for seconds in (1, 2, 3):
            box.put(seconds)
        box.join()
        assert now() == 6
    """,
    "a_thread_pool_works_side_by_side": """
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            def work(seconds):
                time.sleep(seconds)
                return now()
            assert list(pool.map(work, (1, 2, 3))) == [1, 2, 4]
            slow = pool.submit(work, 10)
            try:
                slow.result(timeout=1)
            except concurrent.futures.TimeoutError:
                assert now() == 5
        assert slow.result() == now() == 14
    """,
    "join_waits_for_the_end_of_a_thread_or_for_its_timeout": """
        sleeper = after(2, lambda: None)
        sleeper.join(timeout=0.5)
        assert sleeper.is_alive() and now() == 0.5
        sleeper.join()
        assert not sleeper.is_alive() and now() == 2
        sleeper.join()
        sleeper.join(timeout=1)
        assert now() == 2
    """,
    "several_threads_may_join_one": """
        sleeper, ends = after(2, lambda: None), []
        def join(timeout):
            sleeper.join(timeout)
            ends.append((now(), sleeper.is_alive()))
        for each in [thread(join, timeout) for timeout in (None, 1, 3)]:
            each.join()
        assert ends == [(1, True), (2, False), (2, False)], ends
    """,
    "a_thread_that_raises_has_ended": """
        threading.excepthook = lambda _: None
        def fail():
            time.sleep(1)
            raise OSError
        failing = thread(fail)
        failing.join()
        assert not failing.is_alive() and now() == 1
    """,
    "a_thread_is_alive_from_its_start_and_starts_only_once": """
        late = threading.Thread(target=lambda: None)
        assert not late.is_alive()
        late.start()
        assert late.is_alive()
        late.join()
        try:
            late.start()
        except RuntimeError:
            pass
        else:
            raise AssertionError
    """,
    "threads_start_in_order_and_name_themselves": """
        names = []
        def say():
            names.append(threading.current_thread().name)
        for number in range(5):
            threading.Thread(target=say, name=f"n{number}").start()
        time.sleep(0)
        assert names == ["n0", "n1", "n2", "n3", "n4"]
    """,
    "a_subclass_of_thread_runs_on_virtual_time": """
        class Mine(threading.Thread):
            def run(self):
                time.sleep(7)
                self.ended = now()
        mine = Mine(daemon=True)
        mine.start()
        mine.join()
        assert mine.ended == 7
    """,
    "local_data_and_enumerate_are_those_of_real_threads": """
        data, seen = threading.local(), []
        data.x = "main"
        def look():
            seen.append(hasattr(data, "x"))
            seen.append(threading.current_thread() in threading.enumerate())
        thread(look).join()
        assert seen == [False, True]
    """,
    "threads_outside_the_clock_wait_in_real_time": """
        lock, event, notes = threading.Lock(), threading.Event(), []
        def outside():
            before = real_monotonic()
            time.sleep(0.01)
            notes.append(time.monotonic() - before >= 0.01)
            notes.append(time.monotonic() > 5)
            notes.append(event.wait(0.01))
            with lock:
                notes.append("in")
        orders.put(outside)
        while len(notes) < 4:
            real_sleep(0.001)
        assert notes == [True, True, False, "in"], notes
        assert now() == 0
    """,
    "a_lock_that_an_outside_thread_holds_is_waited_for": """
        lock, taken = threading.Lock(), []
        def outside():
            with lock:
                taken.append(True)
                real_sleep(0.05)
        orders.put(outside)
        while not taken:
            real_sleep(0.001)
        with lock:
            assert now() == 0
    """,
    "a_queue_takes_things_from_an_outside_thread": """
        box = queue.Queue()
        def outside():
            real_sleep(0.02)
            box.put("from outside")
        orders.put(outside)
        assert box.get() == "from outside"
    """,
    "an_outside_thread_takes_things_from_a_queue": """
        box, got = queue.Queue(), []
        orders.put(lambda: got.append(box.get()))
        real_sleep(0.02)
        box.put("to outside")
        while not got:
            real_sleep(0.001)
    """,
    "a_paced_run_waits_for_its_pace_with_the_replaced_locks_too": """
        clock.time.inject(lambda: clock.time.set_speed(20.0))
        before = real_monotonic()
        sleeper = after(0.5, lambda: None)
        time.sleep(1)
        sleeper.join()
        assert real_monotonic() - before >= 0.04
        assert now() == 1
    """,
    "an_interrupt_ends_every_kind_of_wait": """
        lock, box, event = threading.Lock(), queue.Queue(), threading.Event()
        lock.acquire()
        ends = []
        def wait(how):
            try:
                how()
            except KeyboardInterrupt:
                ends.append(how)
        waits = (lock.acquire, box.get, event.wait, lambda: time.sleep(99), clock.auto_reset_event().wait)
        for how in waits[:4]:
            threading.Thread(target=wait, args=(how,), daemon=True).start()
        def interrupt_all():
            for each in clock.threads:
                clock.interrupt(each.ident)
        clock.call_at(10**9, interrupt_all)
        try:
            threading.Barrier(2).wait()
        except KeyboardInterrupt:
            ends.append("main")
        time.sleep(0)
        assert len(ends) == 5 and "main" in ends, ends
    """,
}


@pytest.mark.parametrize("program", PROGRAMS.values(), ids=PROGRAMS.keys())
def test_on_virtual_time(program: str) -> None:
    run(program)
