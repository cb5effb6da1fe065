"""Parameters that set what is being set, and exceptions of parameters and of a second shutdown."""

from pathlib import Path

import pytest
from msgspec.structs import replace

from sim.diagnosis import diagnose
from sim.engine.setup import TimedLine
from sim.quantities.nanoseconds import SECOND
from sim.trace.events import Printed
from tests.support.engine_runs import program_setup, run_program, run_to_end

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


@pytest.mark.parametrize(
    ("line", "cure"),
    [
        (
            "node.get_parameter('speed')",
            "declare it first, in __init__: self.declare_parameter('speed', ...)",
        ),
        ("rclpy.shutdown(); rclpy.shutdown()", "to shut down what may be shut down already, call rclpy.try_"),
    ],
)
def test_what_was_not_declared_or_is_shut_down_already_is_told_with_the_call_to_make(
    tmp_path: Path, line: str, cure: str
) -> None:
    (tmp_path / "node.py").write_text(
        f"import rclpy\n\nrclpy.init()\nnode = rclpy.create_node('n')\n{line}\n"
    )
    timeline = run_to_end(program_setup(tmp_path / "node.py", 1.0)).timeline
    told = diagnose(timeline)[0].explained(timeline)
    assert told.cure.startswith(cure)
    assert str(told.place) == "node.py:5"


FORGETS = """
import rclpy
from rclpy.parameter import Parameter

def asked(parameters):
    pass

rclpy.init()
node = rclpy.create_node("node")
node.declare_parameter("speed", 1)
node.add_on_set_parameters_callback(asked)
for value in (2, 3):
    refused = node.set_parameters([Parameter("speed", value=value)])
"""


def test_a_parameter_callback_that_returns_nothing_is_told_with_its_line(tmp_path: Path) -> None:
    run = run_program(tmp_path, FORGETS)
    (found,) = diagnose(run.timeline)
    told = found.explained(run.timeline)
    assert told.what == "asked returned no SetParametersResult, so rclpy refuses what was to be set"
    assert told.cure == "end asked with: return SetParametersResult(successful=True)"
    assert str(told.place) == "node.py:5"


ASKS = """
import rclpy
from rcl_interfaces.msg import SetParametersResult
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup as Group
from rclpy.executors import MultiThreadedExecutor
from std_srvs.srv import Trigger


def serve(request, response):
    response.success = True
    return response


def asked(parameters):
    return SetParametersResult(successful=client.call(Trigger.Request()).success)


rclpy.init()
node = rclpy.create_node("tuned")
node.declare_parameter("speed", 1.0)
node.create_service(Trigger, "lamp", serve)
client = node.create_client(Trigger, "lamp")
node.add_on_set_parameters_callback(asked)
rclpy.spin(node)
"""
TWO_THREADS = ("spin(node)", "spin(node, MultiThreadedExecutor(2))")
GROUPS = (
    (", serve)", ", serve, callback_group=Group())"),
    ('t(Trigger, "lamp")', 't(Trigger, "lamp", callback_group=Group())'),
)


@pytest.mark.parametrize(
    ("changes", "needs", "cure"),
    [
        (
            (),
            "group A, which the setting of parameters holds",
            "or give serve and the client of /lamp a callback group each, and spin with "
            "MultiThreadedExecutor(num_threads=2)",
        ),
        (
            GROUPS,
            "the only thread, which sets parameters",
            "or give serve and the client of /lamp a callback group each, and spin with "
            "MultiThreadedExecutor(num_threads=2)",
        ),
        (
            (GROUPS[0], TWO_THREADS),
            "group B, which the setting of parameters holds",
            "or give the client of /lamp a callback group of its own",
        ),
        ((*GROUPS, TWO_THREADS), "", ""),
    ],
    ids=["one group", "one thread", "the client's group", "cured"],
)
def test_a_parameter_callback_that_waits_for_what_the_setting_keeps_out_is_told_with_its_line(
    changes: tuple[tuple[str, str], ...], needs: str, cure: str, tmp_path: Path
) -> None:
    source = ASKS
    for change in changes:
        source = source.replace(*change)
    (tmp_path / "node.py").write_text(source)
    setup = program_setup(tmp_path / "node.py", 4.0)
    line = TimedLine(SECOND, "ros2 param set /tuned speed 2.0")
    timeline = run_to_end(replace(setup, lines=(line,))).timeline
    told = [each.explained(timeline) for each in diagnose(timeline)]
    assert len(told) == bool(needs)
    for each in told:
        assert each.what.startswith("deadlock: asked, a callback of parameters, waits for /lamp for ever; ")
        assert each.what.endswith(needs)
        assert each.cure.endswith(cure)
        assert str(each.place) == "node.py:15"
        assert each.for_ever
