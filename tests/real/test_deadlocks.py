"""What waits for itself does so on real rclpy and on the model, and is told with the same words."""

import pytest

from sim.engine.setup import RealRos
from tests.real.deadlocks import Case, seen
from tests.real.programs import needs_ros
from tests.support.daily import first_slow


@needs_ros
@pytest.mark.parametrize(
    "case",
    first_slow(
        Case("multi 2", "same group", "call()", "subscription"),
        Case("single", "same group", "call()", "timer"),
        Case("single", "reentrant group", "call()", "service"),
        Case("multi 1", "reentrant group", "call()", "subscription"),
        Case("multi 2", "split groups", "call()", "service"),
        Case("multi 2", "same group", "nested spin", "timer"),
        Case("multi 4", "reentrant group", "nested spin", "timer"),
        Case("global", "same group", "nested spin", "service"),
        Case("global", "reentrant group", "nested spin", "timer"),
    ),
    ids=", ".join,
)
def test_a_callback_that_asks_its_own_node_hangs_on_both_or_on_neither(case: Case) -> None:
    assert seen(case, RealRos()) == seen(case, None)
