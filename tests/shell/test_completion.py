"""Completion: what can stand at the cursor."""

import pytest

from sim.files.plain_yaml import load
from sim.interfaces import message, message_of_type, service
from sim.packages import Packages
from sim.ros.node.node import Node
from sim.shell import complete, word_start
from sim.shell.messages import Outgoing
from sim.shell.model_ground import ModelGround
from sim.shell.splitting import scan
from tests.support.simulation import Simulation, simulate


def completed(text: str, packages: Packages | None = None, cursor: int | None = None) -> list[str]:
    """The candidates at the cursor, by default at the end, among a few nodes."""
    found: list[str] = []

    def program(simulation: Simulation) -> None:
        node = Node("turtle")
        node.declare_parameter("speed", 1.0)
        node.create_publisher(message("geometry_msgs", "Twist"), "/cmd_vel", 10)
        node.create_publisher(message("std_msgs", "Int32"), "/count", 10)
        node.create_service(service("std_srvs", "SetBool"), "/dummy_server_srv", lambda _, response: response)
        at = len(text) if cursor is None else cursor
        found.extend(complete(ModelGround(simulation.host), packages or Packages(), text, at))

    simulate(program)
    return found


@pytest.mark.parametrize(
    ("text", "candidates"),
    [
        ("r", ["ros2", "run"]),
        ("ros2 se", ["service"]),
        ("ros2 topic ", ["bw", "delay", "echo", "find", "hz", "info", "list", "pub", "type"]),
        ("topic pub /c", ["/cmd_vel", "/count"]),
        ("topic pub /cmd_vel ", ["geometry_msgs/msg/Twist"]),
        ("topic pub /new std_msgs/msg/Int3", ["std_msgs/msg/Int32", "std_msgs/msg/Int32MultiArray"]),
        ("topic pub -r 10 /count ", ["std_msgs/msg/Int32"]),
        ("topic pub --o", ["--once"]),
        ("topic echo --qos-reliability r", ["reliable"]),
        ("service call /dum", ["/dummy_server_srv"]),
        ("service call /dummy_server_srv ", ["std_srvs/srv/SetBool"]),
        ("service call /dummy_server_srv std_srvs/srv/SetBool ", ["data:\\ false"]),
        ("service call /dummy_server_srv std_srvs/srv/SetBool data:\\ f", ["data:\\ false"]),
        ("service call /dummy_server_srv std_srvs/srv/SetBool 'data: f", ["data:\\ false"]),
        ("node info ", ["/turtle"]),
        ("param get /turtle sp", ["speed"]),
        ("interface show std_srvs/srv/S", ["std_srvs/srv/SetBool"]),
        ("run nope ", []),
        ("run nope exe -", []),
        ("topic pub /x no/Such ", []),
        ("nope ", []),
        ("topic list 'unclosed", []),
    ],
)
def test_candidates_fit_the_place(text: str, candidates: list[str]) -> None:
    assert completed(text) == candidates


@pytest.mark.parametrize(
    ("line", "prototype"),
    [
        (
            "topic pub /cmd_vel geometry_msgs/msg/Twist ",
            '"{linear: {x: 0.0, y: 0.0, z: 0.0}, angular: {x: 0.0, y: 0.0, z: 0.0}}"',
        ),
        ("service call /add example_interfaces/srv/AddTwoInts ", '"{a: 0, b: 0}"'),
        ("action send_goal /f example_interfaces/action/Fibonacci ", "order:\\ 0"),
        ('topic pub /l std_msgs/msg/ColorRGBA "{r', '"{r: 0.0, g: 0.0, b: 0.0, a: 0.0}"'),
    ],
)
def test_a_prototype_is_one_line_for_the_prompt(line: str, prototype: str) -> None:
    assert completed(line) == [prototype]


@pytest.mark.parametrize("name", ["geometry_msgs/msg/Twist", "sensor_msgs/msg/Imu", "std_msgs/msg/Header"])
def test_a_prototype_is_read_back_as_the_default_message(name: str) -> None:
    (prototype,) = completed(f"topic pub /new {name} ")
    assert "\n" not in prototype
    (word,) = scan(prototype).words
    cls = message_of_type(name)
    assert Outgoing(cls, load(word.text)).message == cls()


def test_packages_and_what_they_hold_are_candidates(packages: Packages) -> None:
    assert completed("run u", packages) == ["unit5_pkg"]
    assert completed("ros2 run unit5_pkg ", packages) == ["callback_groups_examples", "exercise51"]
    assert completed("launch unit5_pkg ", packages) == ["exercise51.launch.py"]


def test_only_what_stands_before_the_cursor_counts() -> None:
    text = "topic pub /co std_msgs/msg/Int32"
    assert completed(text, cursor=13) == ["/count"]
    assert text[word_start(text, 13) : 13] == "/co"
    assert word_start("topic ", 6) == 6
