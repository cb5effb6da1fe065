"""Waits that never end are told, as what they are; whatever threads do, no other is called a deadlock."""

import subprocess
import sys
from pathlib import Path

from sim.diagnosis import Weight, diagnose
from sim.trace.events import Notice, Severity
from tests.support.engine_runs import SECOND, Run, run_program

_RANDOM_THREADS = r"""
import os, random, re, sys, threading, time
from collections import Counter
from sim.clock import VirtualClock
from sim.clock.strategies import schedule_of
from sim.clock.stdlib import live_on
from sim.engine.watchdogs.endless_waits import EndlessWaits
from sim.ros.middleware.host import Host, install
from sim.probes.probe import SilentProbe

class Probe(SilentProbe):
    def callback_here(self):
        name = threading.current_thread().name
        return int(name[1:]) if name[0] == "T" else 0

clock = VirtualClock(schedule=schedule_of(int(sys.argv[1])))
host = Host(clock, Probe(clock))
install(host)
told = []
waits = EndlessWaits(clock, host, told.append)
clock.time.before_jump, clock.on_lock_wait = waits.look, waits.begins
live_on(clock)
chance = random.Random(int(sys.argv[1]))
kinds = Counter()
ended = set()
rounds = int(sys.argv[2])

def signals_of_a_third():
    # A circle of locks that another thread opens from outside.
    one, two = threading.Lock(), threading.Lock()
    def pass_by(first, second):
        first.acquire()
        time.sleep(0.5)
        second.acquire()
    def give():
        time.sleep(2)
        one.release()
        two.release()
    threads = [
        threading.Thread(target=pass_by, args=(one, two), name="T1"),
        threading.Thread(target=pass_by, args=(two, one), name="T2"),
        threading.Thread(target=give),
    ]
    for each in threads:
        each.start()
    for each in threads:
        each.join()
    assert told == [], told

signals_of_a_third()

def nested(locks, events, signals, depth=0):
    # What a thread does, as a list of functions.
    steps = []
    for _ in range(chance.randint(1, 3)):
        what = chance.choice(["sleep", "with", "with", "acquire", "set", "wait", "give", "await", "join"])
        lock, event, signal = chance.choice(locks), chance.choice(events), chance.choice(signals)
        inside = nested(locks, events, signals, depth + 1) if depth < 2 else []
        steps.append({
            "sleep": lambda t=chance.choice([0, 0.5, 4]): time.sleep(t),
            "with": lambda lock=lock, inside=inside: within(lock, inside),
            "acquire": lambda lock=lock, inside=inside: held(lock, inside),
            "set": event.set,
            "wait": event.wait,
            "give": lambda signal=signal: signal.release() if signal.locked() else None,
            "await": signal.acquire,
            "join": lambda: another().join(),
        }[what])
    return steps

def started(thread):
    thread.start()
    return thread

def another():
    others = [each for each in threads if each is not threading.current_thread() and each.ident]
    return others[0] if others else started(threading.Thread(target=time.time))

def carry_out(steps):
    for step in steps:
        step()

def within(lock, steps):
    with lock:
        carry_out(steps)

def held(lock, steps):
    lock.acquire()
    carry_out(steps)
    lock.release()

for number in range(rounds):
    told.clear()
    another_lives = number % 2 == 1
    locks = [threading.Lock(), threading.Lock(), threading.RLock()]
    events = [threading.Event(), threading.Event()]
    signals = [threading.Lock(), threading.Lock()]
    def live(name, steps):
        carry_out(steps)
        ended.add(name)
    threads = []
    for place in range(chance.randint(1, 3)):
        name, steps = f"T{number * 10 + place + 1}", nested(locks, events, signals)
        threads.append(threading.Thread(target=live, args=(name, steps), name=name, daemon=True))
    for each in threads:
        each.start()
    if another_lives:
        time.sleep(100)
    else:
        over = threading.Lock()
        over.acquire()
        clock.call_at(clock.now() + 100_000_000_000, over.release)
        over.acquire()
    stuck = {each.name for each in threads} - ended
    dead = set()
    for each in told:
        if each.entity:
            kinds[each.severity.value, another_lives] += 1
            kinds["join"] += " to end" in each.text
            if each.severity.value == "ERROR":
                dead |= set(re.findall(r"(T\d+) \(", each.text))
    assert not dead & ended, (number, told)
    assert another_lives or stuck <= dead, (number, stuck, told)
    kinds["well"] += not stuck
assert all(kinds[each] for each in [("ERROR", False), ("ERROR", True), ("WARN", True), "well", "join"]), kinds
print("to the end", flush=True)
os._exit(0)
"""


def test_only_threads_that_never_go_on_are_told_to_be_in_a_deadlock_and_none_is_missed() -> None:
    """In a process of its own, for which time is replaced for good; seed 0 is the usual order."""
    for seed in ("0", "5"):
        ended = subprocess.run(
            [sys.executable, "-c", _RANDOM_THREADS, seed, "150"],
            capture_output=True,
            text=True,
            cwd=Path(__file__).parents[3],
            check=False,
        )
        assert (ended.stderr, ended.stdout) == ("", "to the end\n"), seed


_NODE = """
import threading
import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node

class Mine(Node):
    def __init__(self):
        super().__init__("mine")
        self.lock, self.event = threading.Lock(), threading.Event()
        for callback in CALLBACKS:
            self.create_timer(0.1, getattr(self, callback), callback_group=MutuallyExclusiveCallbackGroup())

    def twice(self):
        with self.lock:
            self.again()

    def again(self):
        with self.lock:
            pass

    def hold(self):
        with self.lock:
            self.wait()

    def leave(self):
        self.lock.acquire()

    def wait(self):
        self.event.wait()

    def doze(self):
        self.event.wait(timeout=30.0)

    def wake(self):
        if self.get_clock().now().nanoseconds % 10**9 > 5 * 10**8:
            self.event.set()

rclpy.init()
executor = MultiThreadedExecutor(num_threads=THREADS)
executor.add_node(Mine())
"""


def run_node(folder: Path, *callbacks: str, threads: int = 4, spins: str = "executor.spin()") -> Run:
    node = _NODE.replace("CALLBACKS", repr(callbacks)).replace("THREADS", str(threads))
    return run_program(folder, f"{node}{spins}\n")


def told(run: Run) -> list[tuple[Severity, str]]:
    return [(each.severity, each.text) for each in run.events if isinstance(each, Notice)]


def found(run: Run) -> list[str]:
    """What the diagnosis says of the waits."""
    timeline = run.timeline
    findings = [each for each in diagnose(timeline) if each.rule.id == "endless-wait"]
    assert all(each.weight_in(timeline) is Weight.PROBLEM for each in findings)
    return [each.explained(timeline).what for each in findings]


def test_a_lock_taken_twice_and_an_event_that_nobody_sets_are_told_with_their_places(tmp_path: Path) -> None:
    run = run_node(tmp_path, "twice", "wait")
    (twice, once), (waits, long) = told(run)
    assert (twice, waits) == (Severity.ERROR, Severity.WARN)
    assert once.startswith("deadlock: ThreadPoolExecutor-0_")
    assert "(node.py:20, in again) waits for self.lock, which it took itself at node.py:16, in tw" in once
    assert "(node.py:31, in wait) waits in Event.wait(), since 0.100 s; " in long
    assert [what.partition(": ")[0] for what in found(run)] == ["wait stands still"]


def test_a_wait_is_told_when_it_has_lasted_long_also_if_nothing_else_happens(tmp_path: Path) -> None:
    run = run_node(tmp_path, "wait")
    assert [each.t for each in run.events if isinstance(each, Notice)] == [3_100_000_000]


def test_the_advice_on_a_lock_whose_holder_waits_itself_is_not_to_take_it_by_with(tmp_path: Path) -> None:
    (_, event), (_, lock) = told(run_node(tmp_path, "hold", "again"))
    assert "waits in Event.wait(), since 0.100 s; wait with a timeout" in event
    assert lock.endswith("let go of a lock before you wait for anything else")


def test_a_thread_that_waits_when_no_other_is_left_is_in_a_deadlock(tmp_path: Path) -> None:
    run = run_node(tmp_path, "leave", "wake", spins="rclpy.spin(executor.get_nodes()[0])")
    ((severity, text),) = told(run)
    assert severity is Severity.ERROR
    took = "self.lock, which it took itself at node.py:28, in leave and did not release"
    assert f"(node.py:28, in leave) waits for {took}, and " in text
    assert "no thread of the program is left that could end that" in text
    (notice,) = (each for each in run.events if isinstance(each, Notice))
    assert 0.2 * SECOND <= notice.t < 0.3 * SECOND


def test_waits_that_end_and_waits_with_a_timeout_are_not_told_of(tmp_path: Path) -> None:
    run = run_node(tmp_path, "wait", "doze", "wake")
    assert (told(run), found(run)) == ([], [])
