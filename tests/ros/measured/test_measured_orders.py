"""What plain programs were measured to say on real rclpy, they say on the model, too, and do so still."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from msgspec.structs import replace

from sim.trace.events import Printed
from tests.real.programs import needs_ros
from tests.ros.measured.orders import ORDERS, Order
from tests.support.daily import first_slow
from tests.support.engine_runs import Run, program_setup, run_program, run_to_end

each_order = pytest.mark.parametrize("order", ORDERS, ids=lambda order: order.what)


@each_order
def test_the_model_keeps_the_measured_order(order: Order, tmp_path: Path) -> None:
    run = run_program(tmp_path, order.source)
    assert _printed(run) == order.lines


@pytest.mark.parametrize(
    "order", first_slow(*(order for order in ORDERS if order.also)), ids=lambda order: order.what
)
def test_explore_comes_upon_the_other_order_that_real_rclpy_was_seen_to_take(
    order: Order, tmp_path: Path
) -> None:
    path = tmp_path / "node.py"
    path.write_text(order.source)
    setup = program_setup(path, 5.0)
    runs = (run_to_end(replace(setup, seed=f"pos:{number}")) for number in range(1, 100))
    assert any(_printed(run) == order.also for run in runs)


@needs_ros
@pytest.mark.slow
@each_order
def test_real_rclpy_keeps_the_measured_order(order: Order, tmp_path: Path) -> None:
    program = tmp_path / "node.py"
    program.write_text(order.source)
    alone = {"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST", "ROS_DOMAIN_ID": str(os.getpid() % 100 + 1)}
    done = subprocess.run(
        [sys.executable, program],
        capture_output=True,
        text=True,
        check=False,
        cwd=tmp_path,
        env={**os.environ, **alone},
    )
    # On a slow machine it may not come to the last lines before its time is over.
    said = done.stdout.splitlines()
    known = [lines.split(", ") for lines in (order.lines, order.also) if lines]
    assert said in [lines[: max(len(said), len(lines) // 2)] for lines in known]


def _printed(run: Run) -> str:
    return ", ".join(event.text for event in run.events if isinstance(event, Printed))
