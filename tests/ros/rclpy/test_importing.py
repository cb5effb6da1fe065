"""What ``import rclpy`` means after ``importing.install()``."""

import subprocess
import sys
import textwrap

import pytest


def in_a_fresh_process(program: str) -> str:
    code = "from sim.ros import importing\nimporting.install()\n" + textwrap.dedent(program)
    return subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout


def test_a_library_runs_on_the_real_clock_without_an_engine() -> None:
    said = in_a_fresh_process("""
        import time
        import rclpy
        from std_msgs.msg import Int32
        from std_srvs.srv import SetBool
        rclpy.init()
        node = rclpy.create_node("n")
        heard = []
        node.create_subscription(Int32, "t", lambda message: heard.append(message.data), 10)
        publisher = node.create_publisher(Int32, "t", 10)
        before = time.monotonic()
        node.create_timer(0.05, lambda: publisher.publish(Int32(data=len(heard))))
        while len(heard) < 3:
            rclpy.spin_once(node)
        assert time.monotonic() - before >= 0.14
        print(heard, SetBool.Request(data=True))
        rclpy.shutdown()
    """)
    assert said == "[0, 1, 2] std_srvs.srv.SetBool_Request(data=True)\n"


@pytest.mark.parametrize(
    ("module", "name"),
    [
        ("rclpy.executors", "ExternalShutdownException"),
        ("rclpy.exceptions", "ParameterNotDeclaredException"),
        ("rclpy.exceptions", "InvalidTopicNameException"),
    ],
)
def test_exceptions_are_called_by_rclpys_names(module: str, name: str) -> None:
    said = in_a_fresh_process(f"import {module}\nprint({module}.{name}.__module__)")
    assert said == f"{module}\n"


def test_messages_to_test_with_are_imported_as_in_ros() -> None:
    said = in_a_fresh_process("""
        from test_msgs.message_fixtures import get_test_msg
        print(type(get_test_msg("BasicTypes")[0]).__module__)
    """)
    assert said == "test_msgs.msg._basic_types\n"
