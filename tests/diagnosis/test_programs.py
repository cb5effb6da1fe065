"""Runs of the engine: what a program leaves behind when it ends is no trouble, and a deadlock is told."""

from pathlib import Path

import pytest
from msgspec.structs import replace

from cbtui.runs.headless.headless import run_headless
from sim.diagnosis import diagnose
from sim.engine.setup import ProgramSetup, RealRos, RobotUse, RunSetup
from sim.trace.timeline import Timeline
from tests.real.programs import needs_ros
from tests.support.engine_runs import SECOND, Run, program_setup, run_program, run_to_end

TALKER = """
import rclpy
from rclpy.node import Node
from std_msgs.msg import Int32

rclpy.init()
node = Node("talker")
publisher = node.create_publisher(Int32, "numbers", 10)
node.create_timer(0.25, lambda: publisher.publish(Int32()))
rclpy.spin(node)
"""

LISTENER = """
import rclpy
from rclpy.node import Node
from std_msgs.msg import Int32

class Listener(Node):
    def __init__(self):
        super().__init__("listener")
        self.create_subscription(Int32, "numbers", self.heard, 5)

    def heard(self, number):
        rclpy.shutdown()

rclpy.init()
listener = Listener()
try:
    rclpy.spin(listener)
except rclpy.executors.ExternalShutdownException:
    pass
"""

CALLER = """
import rclpy
from rclpy.node import Node
from std_srvs.srv import SetBool

class Caller(Node):
    def __init__(self):
        super().__init__("caller")
        self.create_service(SetBool, "own", self.serve)
        self.client = self.create_client(SetBool, "own")
        self.create_timer(1.0, self.tick)

    def serve(self, request, response):
        return response

    def tick(self):
        self.client.call(SetBool.Request())

rclpy.init()
rclpy.spin(Caller())
"""


def problems(run: Run) -> list[str]:
    timeline = run.timeline
    found = diagnose(timeline)
    return [f"{each.rule.id}: {each.explained(timeline).what}" for each in found]


def run_together(folder: Path, *sources: str) -> Run:
    """Run programs together, named by their places: ``node0.py``, ``node1.py``."""
    paths = [folder / f"node{place}.py" for place, _ in enumerate(sources)]
    for path, source in zip(paths, sources, strict=True):
        path.write_text(source)
    return run_to_end(
        RunSetup(
            title="together",
            programs=tuple(ProgramSetup(str(path)) for path in paths),
            clock="virtual",
            speed=None,
            until=10 * SECOND,
            robot=RobotUse.NEVER,
        )
    )


def test_a_program_that_ended_neither_waits_nor_loses_messages(tmp_path: Path) -> None:
    assert problems(run_together(tmp_path, TALKER, LISTENER)) == []


def test_an_exception_that_ends_one_of_two_programs_is_told_once_and_while_the_other_goes_on(
    tmp_path: Path,
) -> None:
    run = run_together(tmp_path, TALKER, "raise KeyError")
    told = "program-raised: the program raised KeyError"
    assert problems(run) == [told]
    before = Timeline()
    before.extend([each for each in run.events if each.t <= SECOND])
    (found,) = diagnose(before)
    assert found.until < SECOND
    explained = found.explained(before)
    assert (explained.what, str(explained.place)) == (told.partition(": ")[2], "node1.py:1")


def test_a_deadlock_is_told_with_the_line_of_its_callback(tmp_path: Path) -> None:
    run = run_program(tmp_path, CALLER)
    assert problems(run) == [
        "self-made-deadlock: deadlock: tick waits for /own for ever; "
        "/own waits for group A, which tick (node.py:17) holds"
    ]
    timeline = run.timeline
    (found,) = diagnose(timeline)
    assert str(found.explained(timeline).place) == "node.py:17"


@pytest.mark.parametrize(
    ("source", "told"),
    [
        (
            CALLER,
            [
                "Diagnosis",
                "  ! deadlock: tick waits for /own for ever; /own waits for group A, which tick",
                "    (node.py:17) holds.",
                "    The executor brings request and reply, and each needs a group that lets it",
                "    in and a thread.",
                "    → use call_async() and return from tick, or give tick a callback group of",
                "      its own, and spin with MultiThreadedExecutor(num_threads=2).",
                "      node.py:17, at 1.000 s",
            ],
        ),
        (TALKER, []),
    ],
)
def test_a_run_without_the_console_lists_its_findings_after_the_summary(
    source: str, told: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "node.py"
    path.write_text(source)
    status = run_headless(program_setup(path, 3.0))
    assert status == 0
    summary, _, listing = capsys.readouterr().out.partition("\nDiagnosis\n")
    assert summary.startswith("node.py, 3.0 s of virtual time")
    assert (["Diagnosis", *listing.splitlines()] if listing else []) == told


RAISES_BESIDE_WORK = """
import time
import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from rclpy.task import Future

class Worker(Node):
    def __init__(self):
        super().__init__("worker")
        self.create_timer(0.2, self.work, MutuallyExclusiveCallbackGroup())
        self.create_timer(0.5, self.tick)

    def work(self):
        time.sleep(6.0)

    def tick(self):
        future = Future(executor=self.executor)
        future.add_done_callback(self.keep)
        future.set_result("handle")

    def keep(self, future):
        self.handle = future.result()

rclpy.init()
executor = MultiThreadedExecutor(2)
executor.add_node(Worker())
executor.spin()
"""


@pytest.mark.parametrize("real", [None, pytest.param(RealRos(), marks=[needs_ros, pytest.mark.slow])])
def test_what_ends_main_is_told_when_it_is_raised_and_alone_though_a_worker_goes_on(
    real: RealRos | None, tmp_path: Path
) -> None:
    (tmp_path / "node.py").write_text(RAISES_BESIDE_WORK)
    setup = program_setup(tmp_path / "node.py", 3.0, "virtual" if real is None else "real")
    run = run_to_end(replace(setup, real=real))
    [found] = diagnose(run.timeline)
    assert found.rule.id == "program-raised"
    assert SECOND // 2 <= found.at < 2 * SECOND
    told = found.explained(run.timeline)
    assert told.what == "the program raised AttributeError: handle cannot be modified after node creation"
    assert told.cure == "give the attribute another name, such as my_handle"
    assert run.ending.failed
    assert run.ending.time_was_up
