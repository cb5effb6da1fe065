"""Launch files in XML and YAML: the same processes as from Python."""

from pathlib import Path

import pytest

from sim.launch import LaunchError, LaunchRun, describe_arguments
from sim.ros.context.arguments import parse_arguments
from tests.launch.fakes import FakeMachine, make_package

XML = """<?xml version="1.0"?>
<launch>
  <!-- As a tutorial has it. -->
  <arg name="speed" default="0.5" description="how fast"/>
  <arg name="sim" default="false"/>
  <let name="area" value="hall"/>
  <group>
    <push-ros-namespace namespace="$(var area)"/>
    <node pkg="unit5_pkg" exec="exercise51" name="driver" output="screen" args="--fast '$(var speed) now'">
      <param name="pace" value="$(var speed)"/>
      <param name="label" value="5" type="str"/>
      <param name="count" value="3"/>
      <param name="gains">
        <param name="p" value="1.5"/>
      </param>
      <param from="$(find-pkg-share unit5_pkg)/config/speeds.yaml"/>
      <remap from="/cmd_vel" to="$(var area)/cmd_vel"/>
      <env name="LEVEL" value="3"/>
    </node>
  </group>
  <node pkg="unit5_pkg" exec="exercise51" if="$(var sim)"/>
  <node pkg="unit5_pkg" exec="exercise51" unless="$(eval '$(var speed) > 1')" namespace="other"/>
  <executable cmd="ros2 topic list" output="screen"/>
  <timer period="2.0">
    <log message="later: $(env NOBODY_SETS_THIS 'not there')"/>
  </timer>
</launch>
"""
YAML = """
launch:
- arg: {name: speed, default: '0.5', description: how fast}
- arg: {name: sim, default: 'false'}
- let: {name: area, value: hall}
- group:
  - push_ros_namespace:
      namespace: $(var area)
  - node:
      pkg: unit5_pkg
      exec: exercise51
      name: driver
      output: screen
      args: --fast '$(var speed) now'
      param:
      - {name: pace, value: $(var speed)}
      - {name: label, value: '5', type: str}
      - {name: count, value: 3}
      - name: gains
        param:
        - {name: p, value: 1.5}
      - from: $(find-pkg-share unit5_pkg)/config/speeds.yaml
      remap:
      - {from: /cmd_vel, to: $(var area)/cmd_vel}
      env:
      - {name: LEVEL, value: '3'}
- node: {pkg: unit5_pkg, exec: exercise51, if: $(var sim)}
- node: {pkg: unit5_pkg, exec: exercise51, unless: $(eval '$(var speed) > 1'), namespace: other}
- executable: {cmd: ros2 topic list, output: screen}
- timer:
    period: 2.0
    children:
    - log: {message: "later: $(env NOBODY_SETS_THIS 'not there')"}
"""


def launched(folder: Path, name: str, text: str, *arguments: str) -> FakeMachine:
    file = make_package(folder) / "launch" / name
    file.write_text(text)
    machine = FakeMachine()
    LaunchRun(file, arguments, machine).start()
    return machine


@pytest.mark.parametrize(
    ("name", "text"), [("robot.launch.xml", XML), ("robot.launch.yaml", YAML)], ids=["xml", "yaml"]
)
def test_a_tutorials_file_starts_what_it_says(name: str, text: str, tmp_path: Path) -> None:
    machine = launched(tmp_path, name, text, "speed:=0.75")
    driver, other, line = machine.processes
    spec = machine.spec(0)
    assert (spec.label, spec.output, spec.environment) == ("exercise51-1", "screen", {"LEVEL": "3"})
    assert spec.arguments[:2] == ("--fast", "0.75 now")
    parsed = parse_arguments(spec.arguments)
    assert {
        "pace": 0.75,
        "speed": 0.5,
        "label": "5",
        "count": 3,
        "gains.p": 1.5,
    }.items() <= parsed.parameters["/**"].items()
    assert "__ns:=/hall" in spec.arguments
    assert "/cmd_vel:=hall/cmd_vel" in spec.arguments
    assert any(each.endswith("config/speeds.yaml") for each in spec.arguments)
    assert machine.spec(1).label == "exercise51-2"
    assert "__ns:=/other" in machine.spec(1).arguments
    assert line.spec == ("ros2", "topic", "list")
    assert driver is not other
    machine.pass_time(2.0)
    assert machine.said[-1] == "[INFO] [launch.user]: later: not there"


def test_files_of_any_kind_include_each_other(tmp_path: Path) -> None:
    root = make_package(tmp_path)
    (root / "launch" / "inner.launch.yaml").write_text(
        "launch:\n- arg: {name: who}\n- log: {message: hello $(var who)}\n"
        "- include: {file: $(dirname)/last.launch.py}\n"
    )
    (root / "launch" / "last.launch.py").write_text(
        "from launch import LaunchDescription\nfrom launch.actions import IncludeLaunchDescription, LogInfo\n"
        "from launch_xml.launch_description_sources import XMLLaunchDescriptionSource\n"
        "from launch.substitutions import PathJoinSubstitution, ThisLaunchFileDir\n"
        "there = PathJoinSubstitution([ThisLaunchFileDir(), 'end.launch.xml'])\n"
        "def generate_launch_description():\n    return LaunchDescription([LogInfo(msg='python'), "
        "IncludeLaunchDescription(XMLLaunchDescriptionSource(there))])\n"
    )
    (root / "launch" / "end.launch.xml").write_text("<launch><log message='end' if='$(not false)'/></launch>")
    outer = root / "launch" / "outer.launch.xml"
    outer.write_text(
        '<launch><include file="$(find-pkg-share unit5_pkg)/launch/inner.launch.yaml">'
        '<arg name="who" value="you"/></include></launch>'
    )
    (root / "setup.py").write_text((root / "setup.py").read_text().replace("*.launch.py", "*"))
    machine = FakeMachine()
    run = LaunchRun(outer, [], machine)
    run.start()
    assert run.error is None
    assert [line.rpartition(": ")[2] for line in machine.said[1:]] == ["hello you", "python", "end"]


def test_its_arguments_are_described(tmp_path: Path) -> None:
    file = make_package(tmp_path) / "launch" / "robot.launch.xml"
    file.write_text(XML)
    said = describe_arguments(file)
    assert "'speed'" in said
    assert "how fast" in said


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("a.launch.xml", "<launch>\n<node>\n</launch>", "a.launch.xml:3: mismatched tag"),
        ("a.launch.xml", "<robot/>", "a.launch.xml:1: a launch file's root is 'launch', not 'robot'"),
        (
            "a.launch.xml",
            "<launch>\n<nod/></launch>",
            "a.launch.xml:2: there is no action <nod>; there are arg,",
        ),
        (
            "a.launch.xml",
            "<launch><node exec='x'/></launch>",
            "a.launch.xml:1: <node> needs the attribute 'pkg'",
        ),
        (
            "a.launch.xml",
            "<launch>\n<node pkg='unit5_pkg' exec='x' speed='3'/></launch>",
            "a.launch.xml:2: <node> has no attribute 'speed'",
        ),
        (
            "a.launch.yaml",
            "launch:\n- log: {message: $(vra x)}",
            "a.launch.yaml:2: there is no substitution $(vra …)",
        ),
        (
            "a.launch.yaml",
            "launch:\n- log: {message: $(var x}",
            "a.launch.yaml:2: the closing bracket of $(var x is",
        ),
        (
            "a.launch.yaml",
            "launch:\n- log: {message: $(var)}",
            "a.launch.yaml:2: $(var …) does not take 0 arguments",
        ),
        ("a.launch.yaml", "launch:\n  - node: [", "a.launch.yaml:2: "),
        (
            "a.launch.yaml",
            "nodes: []\nmore: 1",
            "a.launch.yaml: a launch file in YAML is 'launch:' and a list",
        ),
        (
            "a.launch.xml",
            "<launch>\n<node_container pkg='rclcpp_components'/></launch>",
            "a.launch.xml:2: ComposableNodeContainer is not supported: components are compiled from C++",
        ),
        (
            "a.launch.xml",
            "<launch>\n<node pkg='unit5_pkg' exec='nobody'/></launch>",
            "a.launch.xml:2: ",
        ),
    ],
)
def test_what_is_wrong_is_told_with_its_line(name: str, text: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(LaunchError) as error:
        launched(tmp_path, name, text)
    assert str(error.value).startswith(said)
