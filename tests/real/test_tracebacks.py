"""A program's tracebacks on real rclpy: those that it would have without the probe."""

import subprocess
import sys
from pathlib import Path

from sim.probes.on_path.cbtui_probe import CHANGES
from sim.real.programs import claimed_domain, watched_environment
from tests.real.programs import HEAD, needs_ros

FAILS = """
import traceback
from rclpy.executors import ExternalShutdownException

def tried(function, *arguments):
    try:
        function(*arguments)
    except Exception:
        traceback.print_exc()

def spin_on(pool):
    while True:
        pool.spin_once()

class Tried(Node):
    def __init__(self):
        super().__init__("tried")
        self.once = self.create_timer(0.01, self.tick)
        self.again = self.create_timer(0.02, self.tock)

    def tick(self):
        self.once.cancel()
        raise ValueError("ticked")

    async def tock(self):
        raise ValueError("tocked")

rclpy.init()
node = Tried()
executor = SingleThreadedExecutor()
executor.add_node(node)
tried(node.create_publisher, String, "not a name", 10)
tried(node.create_timer)
tried(node.create_publisher(String, "news", 10).publish, 7)
tried(node.create_client(SetBool, "switch").call, 7)
tried(rclpy.spin, node, executor)
pool = MultiThreadedExecutor(2)
pool.add_node(node)
tried(spin_on, pool)
pool.remove_node(node)
executor.add_node(node)
tried(executor.spin_once)
executor.spin()
"""


@needs_ros
def test_the_probe_is_not_in_the_tracebacks_of_a_program(tmp_path: Path) -> None:
    program = tmp_path / "tried.py"
    program.write_text(HEAD + FAILS)

    domain, claim = claimed_domain()

    def printed(**environment: str) -> str:
        done = subprocess.run(
            [sys.executable, program],
            env=watched_environment(sys.executable, tmp_path) | {"ROS_DOMAIN_ID": str(domain)} | environment,
            capture_output=True,
            text=True,
            check=False,
        )
        return done.stderr

    with claim:
        watched = printed()
        assert watched == printed(PYTHONPATH="")
    assert watched.count("Traceback") == 8


@needs_ros
def test_the_interrupt_that_ends_a_run_of_the_console_has_no_traceback(tmp_path: Path) -> None:
    program = tmp_path / "tried.py"
    program.write_text("import rclpy\nraise KeyboardInterrupt\n")

    def printed(**environment: str) -> str:
        command = [sys.executable, str(program)]
        env = watched_environment(sys.executable, tmp_path) | environment
        done = subprocess.run(command, env=env, capture_output=True, text=True, check=False)
        return done.stderr

    assert printed().endswith("\nKeyboardInterrupt\n")
    assert printed(**{CHANGES: "{}"}) == ""
