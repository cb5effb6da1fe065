"""Chains through whole programs, whose latencies are worked out by hand; times in milliseconds."""

from pathlib import Path

import pytest

from sim.trace.figures.chains import chain
from tests.support.daily import first_row_daily
from tests.support.engine_runs import run_program

_FILE = """
import time
import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup as Own, ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.task import Future
from std_msgs.msg import Int32
from std_srvs.srv import SetBool

rclpy.init()
one, two = Node("one"), Node("two")
kept = []

def publisher(topic, depth=10):
    return one.create_publisher(Int32, topic, depth).publish

def serve(request, response):
    time.sleep(0.04)
    return response

{body}
for node in (one, two):
    executor.add_node(node)
executor.spin()
"""

TIMERS = """
executor = SingleThreadedExecutor()
x, y = publisher("/x"), publisher("/y")
one.create_timer(0.1, lambda: x(Int32()))
one.create_timer(0.07, lambda: kept and y(kept[-1]))
one.create_subscription(Int32, "/x", kept.append, 10)
"""
GROUP = """
executor = MultiThreadedExecutor(3)
x, y, shared = publisher("/x"), publisher("/y"), Own()
one.create_timer(0.2, lambda: time.sleep(0.06), callback_group=shared)
one.create_timer(0.1, lambda: x(Int32()), callback_group=Own())
def look(message):
    time.sleep(0.01)
    y(message)
one.create_subscription(Int32, "/x", look, 10, callback_group=shared)
"""
NODES = """
executor = SingleThreadedExecutor()
x, between, y = publisher("/x"), publisher("/between"), publisher("/y")
one.create_timer(0.2, lambda: x(Int32()))
def look(message):
    time.sleep(0.02)
    between(message)
    time.sleep(0.015)
def steer(message):
    time.sleep(0.03)
    y(message)
one.create_subscription(Int32, "/x", look, 10)
two.create_subscription(Int32, "/between", steer, 10)
"""
SERVICE = """
executor = MultiThreadedExecutor(4)
x, y = publisher("/x"), publisher("/y")
find = one.create_client(SetBool, "/find", callback_group=Own())
two.create_service(SetBool, "/find", serve)
one.create_timer(0.2, lambda: x(Int32()), callback_group=Own())
def look(message):
    time.sleep(0.01)
    find.call(SetBool.Request())
    time.sleep(0.005)
    y(message)
one.create_subscription(Int32, "/x", look, 10)
"""
AWAITED = SERVICE.replace("def look", "async def look").replace("find.call(", "await find.call_async(")
REPLY = (
    AWAITED.replace("callback_group=Own())", "callback_group=shared)", 1).replace(
        "find =", "shared = Own()\nfind ="
    )
    + "one.create_timer(0.24, lambda: time.sleep(0.06), callback_group=shared)"
)
WOKEN = """
executor = MultiThreadedExecutor(3)
x, y = publisher("/x"), publisher("/y")
one.create_timer(0.2, lambda: x(Int32()), callback_group=Own())
one.create_timer(0.15, lambda: kept and kept[-1].set_result(None), callback_group=Own())
async def look(message):
    time.sleep(0.01)
    kept.append(Future())
    await kept[-1]
    time.sleep(0.005)
    y(message)
one.create_subscription(Int32, "/x", look, 10)
"""
LOSSES = """
executor = MultiThreadedExecutor(3)
x, y = publisher("/x", 1), publisher("/y")
one.create_timer(0.05, lambda: x(Int32()), callback_group=Own())
def look(message):
    time.sleep(0.13)
    y(message)
one.create_subscription(Int32, "/x", look, 1)
"""
QUEUE = """
executor = SingleThreadedExecutor()
x, y = publisher("/x"), publisher("/y")
one.create_timer(0.5, lambda: [x(Int32()) for _ in range(3)])
def work(message):
    time.sleep(0.1)
    y(message)
one.create_subscription(Int32, "/x", work, 10)
"""


@pytest.mark.parametrize(
    ("body", "until", "names", "inputs", "last", "whole", "costs"),
    first_row_daily(
        # Sent at 100, 200, ..., 700, used at 140, 210, ..., 700, 770. Used again: that of 200 at 280, of 400
        # at 490, of 600 at 700, when the timers come before the subscription.
        (
            TIMERS,
            0.78,
            "/x:/y",
            7,
            [40, 10, 80, 50, 20, 90, 60, 30, 100, 70],
            [40, 10, 50, 20, 60, 30, 70],
            [280],
        ),
        # Of 10 each, every second one waits for the 60 of the other timer; the tenth does not end in time.
        (GROUP, 1.05, "/x:/y", 10, [10, 70] * 4 + [10], [10, 70] * 4 + [10], [4 * 60, 9 * 10]),
        # 20 in look, which runs 15 more while the only thread is wanted, and 30 in steer.
        (NODES, 1.1, "/x:/y", 5, [65] * 5, [65] * 5, [150, 100, 75]),
        # 10 before the call, 40 in the service, 5 behind it.
        (SERVICE, 1.1, "/x:/y", 5, [55] * 5, [55] * 5, [200, 75]),
        (SERVICE, 1.1, "/x:/find:/y", 5, [55] * 5, [55] * 5, [200, 75]),
        # So it is if the call is awaited.
        (AWAITED, 1.1, "/x:/y", 5, [55] * 5, [55] * 5, [200, 75]),
        (AWAITED, 1.1, "/x:/find:/y", 5, [55] * 5, [55] * 5, [200, 75]),
        # The reply of 250 waits until 300, when the timer of its group, which began at 240, is done.
        (REPLY, 0.39, "/x:/y", 1, [105], [105], [50, 40, 15]),
        # Those of 200 and 400 are awaited, from 210 and 410 until the timer comes at 300 and 450.
        (WOKEN, 0.59, "/x:/y", 2, [105, 55], [105, 55], [130, 30]),
        # Sent every 50. Those of 50, 150, 300 and 400 are taken at 50, 180, 310 and 440, and run for 130.
        (LOSSES, 0.69, "/x:/y", 13, [130, 160, 140, 170], [130, 160, 140, 170], [4 * 130, 30 + 10 + 40]),
        # Three at once: one behind the other.
        (QUEUE, 0.95, "/x:/y", 3, [100, 200, 300], [100, 200, 300], [300, 300]),
    ),
    ids=[
        "timers",
        "group",
        "nodes",
        "service",
        "named service",
        "awaited",
        "awaited by name",
        "reply",
        "woken",
        "losses",
        "queue",
    ],
)
def test_latencies_of_a_program(
    body: str,
    until: float,
    names: str,
    inputs: int,
    last: list[int],
    whole: list[int],
    costs: list[int],
    tmp_path: Path,
) -> None:
    found = chain(run_program(tmp_path, _FILE.format(body=body), until).timeline, names.split(":"))
    assert found.inputs == inputs
    assert [run.latency / 1e6 for run in found.runs] == last
    assert [run.latency / 1e6 for run in found.whole_chain] == whole
    assert [cost.total / 1e6 for cost in found.costs if cost.total] == costs
