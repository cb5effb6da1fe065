"""The rule on parameter callbacks that set what is being set."""

from pathlib import Path

from sim.diagnosis import diagnose
from sim.trace.events import Printed
from tests.support.engine_runs import run_program

SETS = """
import rclpy
from rcl_interfaces.msg import SetParametersResult
from rclpy.parameter import Parameter

def asked(parameters):
    for name in (each.name for each in parameters if each.value == 9):
        if name == "own":
            node.set_parameters([Parameter("own", value=4)])
        if name == "first":
            node.set_parameters([Parameter("second", value=9)])
    return SetParametersResult(successful=True)

def was_set(parameters):
    for name in (each.name for each in parameters if each.value == 9):
        if name == "later":
            node.set_parameters([Parameter("later", value=4)])

rclpy.init()
node = rclpy.create_node("node")
for name in ("own", "first", "second", "later"):
    node.declare_parameter(name, 1)
node.add_on_set_parameters_callback(asked)
node.add_post_set_parameters_callback(was_set)
for name in ("own", "first", "later", "own"):
    node.set_parameters([Parameter(name, value=9)])
print(*(node.get_parameter(name).value for name in ("own", "first", "second", "later")))
"""


def test_a_parameter_that_its_callback_sets_while_it_is_set_is_told_once_others_are_not(
    tmp_path: Path,
) -> None:
    run = run_program(tmp_path, SETS)
    assert [each.text for each in run.events if isinstance(each, Printed)] == ["9 9 9 4"]
    (found,) = diagnose(run.timeline)
    assert found.rule.id == "parameter-overruled"
    told = found.explained(run.timeline)
    assert told.what == "a parameter callback sets 'own' while that is being set (node.py:9, in asked)"
    assert "pre-set callback" in told.cure
