"""What generated systems say on the model is decided, and the same on real rclpy."""

import sys

import pytest

from tests.conformance.comparing import Outcome, cases, on_model
from tests.conformance.drawing import drawn
from tests.conformance.programs import program
from tests.conformance.recorded import against_recorded
from tests.conformance.running import run_all
from tests.real.programs import needs_ros


def test_the_model_gives_what_real_ros_2_gave() -> None:
    differing = [
        (kept.distro, kept.seed, came) for kept, came in against_recorded() if came is not Outcome.SAME
    ]
    assert differing == []


@pytest.mark.slow
def test_a_system_that_is_decided_says_the_same_on_the_model_each_time() -> None:
    given = cases(2, seed=3, distro="jazzy@7.1.5")
    again = on_model([each.system for each in given], "jazzy@7.1.5")
    assert [case.model.words for case in given] == [said and said.words for said in again]


@needs_ros
@pytest.mark.slow
def test_every_generated_program_runs_on_real_rclpy() -> None:
    assert all(run_all([program(drawn(f"3-{each}")) for each in range(4)], sys.executable, 4))
