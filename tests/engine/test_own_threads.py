"""Threads that a program starts itself: where they wait is told, until they go on."""

from pathlib import Path

import pytest

from sim.trace.events import CallbackAt, Doing, OwnThreadAt, Printed
from tests.support.engine_runs import run_program

_NODE = """
import threading, time
import rclpy
from rclpy.node import Node

rclpy.init()
node = Node("n")
node.create_timer(1.0, lambda: None)
event, lock = threading.Event(), threading.Lock()
lock.acquire()

def waits():
    event.wait()
    event.clear()
    time.sleep(1.0)

def locks():
    with lock:
        pass

for each in (waits, locks):
    threading.Thread(target=each, name=each.__name__, daemon=True).start()
threading.Thread(target=lambda: rclpy.spin(node), name="spins", daemon=True).start()
time.sleep(2.0)
event.set()
time.sleep(2.0)
"""


def test_a_thread_of_the_program_s_own_is_told_of_while_it_waits(tmp_path: Path) -> None:
    run = run_program(tmp_path, _NODE, seconds=4)
    told = [event for event in run.events if isinstance(event, OwnThreadAt)]
    assert {each.name for each in told} == {"waits", "locks"}
    steps = [(each.doing, each.call) for each in told if each.name == "waits"]
    assert steps[:3] == [(Doing.WAITS, "Event.wait"), (Doing.SLEEPS, "time.sleep"), (Doing.COMPUTES, "")]
    taking = next(each for each in told if each.name == "locks")
    assert (taking.call, taking.lock, taking.frames[-1][1:]) == ("Lock.acquire", "lock", ("locks", 18))
    assert [each.name for each in run.timeline.own_threads_at(run.timeline.end - 1)] == ["locks"]


_ASKS = """
import threading, time
import rclpy
from rclpy.node import Node

def ask():
    end = time.monotonic() + 1.0
    while time.monotonic() < end:
        time.time(), time.perf_counter_ns(), time.time_ns()

rclpy.init()
node = Node("n")
node.create_timer(0.1, ask)
threading.Thread(target=ask, name="asks", daemon=True).start()
rclpy.spin(node)
"""


def test_who_asks_the_time_again_and_again_computes(tmp_path: Path) -> None:
    events = run_program(tmp_path, _ASKS, 3.0, "real").events
    assert {each.doing for each in events if isinstance(each, CallbackAt)} == {Doing.COMPUTES}
    own = [each for each in events if isinstance(each, OwnThreadAt)]
    assert {(each.name, each.doing, each.call) for each in own} == {("asks", Doing.COMPUTES, "")}
    assert (bool(own[0].frames), own[-1].frames) == (True, ()), "it is told of until it is over"


_POOL = """
import threading
from concurrent.futures import ThreadPoolExecutor
import rclpy
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node

rclpy.init()
node = Node("n")
pools = ThreadPoolExecutor(), MultiThreadedExecutor(2), ThreadPoolExecutor()
name = lambda: threading.current_thread().name
tick = lambda: print(*(each.submit(name).result() for each in pools[::2]), name())
node.create_timer(0.5, tick)
rclpy.spin(node, pools[1])
"""


@pytest.mark.parametrize("clock", ["virtual", "real"])
def test_the_pools_of_a_program_and_of_its_executors_have_one_numbering(clock: str, tmp_path: Path) -> None:
    run = run_program(tmp_path, _POOL, seconds=0.8, clock=clock)
    assert "ThreadPoolExecutor-0_0 ThreadPoolExecutor-2_0 ThreadPoolExecutor-1_0" in [
        each.text for each in run.events if isinstance(each, Printed)
    ]
