"""Programs that may wait for themselves, on the model and on real rclpy: ``python -m tests.real.deadlocks``.

An executor of some threads, callback groups, and a callback that asks for a reply its own node has to give.
"""

import argparse
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from itertools import product
from pathlib import Path
from typing import NamedTuple

import msgspec

from cbtui.commands.options.changes import release_of
from sim.diagnosis import Weight, diagnose
from sim.engine.setup import RealRos, RobotUse
from sim.trace.timeline import Timeline
from tests.support.engine_runs import Run, program_setup, run_to_end

_EXECUTORS = {
    "single": "SingleThreadedExecutor()",
    "multi 1": "MultiThreadedExecutor(1)",
    "multi 2": "MultiThreadedExecutor(2)",
    "multi 4": "MultiThreadedExecutor(4)",
    "global": "rclpy.get_global_executor()",
}
_EXCLUSIVE, _REENTRANT = "MutuallyExclusiveCallbackGroup()", "ReentrantCallbackGroup()"
_GROUPS = {
    "same group": f"self.group = self.other = {_EXCLUSIVE}",
    "split groups": f"self.group, self.other = {_EXCLUSIVE}, {_EXCLUSIVE}",
    "reentrant group": f"self.group = self.other = {_REENTRANT}",
}
_WAYS = {
    "call()": "self.client.call(SetBool.Request(data=True))",
    "nested spin": (
        "rclpy.spin_until_future_complete(self, self.client.call_async(SetBool.Request(data=True)))"
    ),
}
_ONCE = f"self.once = self.create_timer(0.5, self.first, callback_group={_EXCLUSIVE})"
_CALLBACKS = {
    "timer": ("self.once = self.create_timer(0.5, self.first, callback_group=self.group)", "self.ask()"),
    "subscription": (
        f'self.create_subscription(String, "news", self.ask, 10, callback_group=self.group); {_ONCE}',
        'self.publisher.publish(String(data="x"))',
    ),
    "service": (
        f'self.create_service(Trigger, "start", self.ask, callback_group=self.group); {_ONCE}',
        "self.trigger.call_async(Trigger.Request())",
    ),
}
_PROGRAM = """
import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import SetBool, Trigger


class Asking(Node):
    def __init__(self):
        super().__init__("asking")
        {groups}
        self.create_service(SetBool, "switch", self.serve, callback_group=self.other)
        self.client = self.create_client(SetBool, "switch", callback_group=self.other)
        self.publisher = self.create_publisher(String, "news", 10)
        self.trigger = self.create_client(Trigger, "start")
        {begin}

    def first(self):
        self.once.cancel()
        {first}

    def serve(self, request, response):
        return response

    def ask(self, *arguments):
        self.get_logger().info("asks")
        {way}
        self.get_logger().info("answered")
        return arguments[-1] if arguments else None


rclpy.init()
node = Asking()
executor = {executor}
executor.add_node(node)
try:
    executor.spin()
except KeyboardInterrupt:
    pass
"""
_SECONDS = 3.5


class Case(NamedTuple):
    """One of the programs, by what it is made of."""

    executor: str
    groups: str
    way: str
    callback: str

    @property
    def text(self) -> str:
        """The program."""
        begin, first = _CALLBACKS[self.callback]
        return _PROGRAM.format(
            groups=_GROUPS[self.groups],
            begin=begin,
            first=first,
            way=_WAYS[self.way],
            executor=_EXECUTORS[self.executor],
        )


class Seen(NamedTuple):
    """Whether the callback got its reply, and what the diagnosis says is wrong."""

    hangs: bool
    problems: tuple[str, ...]


def cases() -> Iterator[Case]:
    """All of them."""
    return (Case(*each) for each in product(_EXECUTORS, _GROUPS, _WAYS, _CALLBACKS))


def seen(case: Case, real: RealRos | None, python: str = "") -> Seen:
    """What comes of a program on a real ROS 2, or on the model of that of a Python, in virtual time."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "asking.py"
        path.write_text(case.text)
        setup = program_setup(path, _SECONDS, clock="virtual" if real is None else "real")
        distro = "" if real is not None else release_of(python) or ""
        run = run_to_end(msgspec.structs.replace(setup, real=real, distro=distro, robot=RobotUse.NEVER))
    texts = _logged(run)
    return Seen("answered" not in texts, tuple(_problems(run.timeline)) if "asks" in texts else ("silent",))


def _logged(run: Run) -> list[str]:
    return [line.text for line in run.timeline.logs]


def _problems(timeline: Timeline) -> Iterator[str]:
    for found in diagnose(timeline):
        if found.weight_in(timeline) is Weight.PROBLEM:
            yield found.explained(timeline).what


def main() -> None:
    """Run all, and tell those that differ; the exit code is 1 if there are any."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--python", default="", help="an interpreter with another ROS 2")
    real = RealRos(python=parser.parse_args().python)
    count, differing = 0, 0
    with ThreadPoolExecutor(2) as pool:
        for case, on_ros, on_model in pool.map(
            lambda each: (each, seen(each, real), seen(each, None, real.python)), cases()
        ):
            count += 1
            print(f"{', '.join(case):60} {'hangs' if on_ros.hangs else 'runs'}", flush=True)
            if on_ros != on_model:
                differing += 1
                print(f"  on real ROS 2: {on_ros}\n  on the model:  {on_model}", flush=True)
    print(f"{differing} of {count} differ")
    sys.exit(bool(differing))


if __name__ == "__main__":
    main()
