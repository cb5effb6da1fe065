"""``ros2 run``, ``launch`` and ``pkg``: what is started, and how its end is told."""

from pathlib import Path

import pytest

from sim.packages import Packages
from tests.shell.lines import carry_out

_COURSE = [
    "ros2 run unit5_pkg callback_groups_examples -service_wait_time 5.0 -timer_period 1.0 "
    f"-callback_group_type {kind} -threads {threads}"
    for kind, threads in (("exclusive", 2), ("reentrant", 2), ("reentrant", 1))
]


@pytest.mark.parametrize("line", _COURSE)
def test_the_courses_run_lines_hand_their_arguments_on_as_they_stand(line: str, packages: Packages) -> None:
    result = carry_out(line, packages=packages)
    (started,) = result.tools.started
    assert started == ("unit5_pkg", "callback_groups_examples", line.split()[4:])
    assert (result.out, result.err, result.status) == ("", "", 0)


def test_two_dashes_and_help_belong_to_the_program(packages: Packages) -> None:
    result = carry_out("run unit5_pkg exercise51 a -- -h --ros-args -r a:=b", packages=packages)
    assert result.tools.started == [
        ("unit5_pkg", "exercise51", ["a", "--", "-h", "--ros-args", "-r", "a:=b"])
    ]


def test_the_courses_launch_line_launches(packages: Packages) -> None:
    result = carry_out("ros2 launch unit5_pkg exercise51.launch.py", packages=packages)
    assert result.tools.started == [("unit5_pkg", "exercise51.launch.py", [])]
    assert result.status == 0


def test_a_launch_file_can_be_given_by_path_and_with_arguments(tmp_path: Path) -> None:
    path = tmp_path / "a.launch.py"
    path.write_text("")
    result = carry_out(f"launch {path} speed:=0.5 name:='a b'")
    assert result.tools.started == [(None, str(path), ["speed:=0.5", "name:=a b"])]


def test_launch_arguments_are_shown(packages: Packages) -> None:
    result = carry_out("launch unit5_pkg exercise51.launch.py --show-args", packages=packages)
    assert result.out == "Arguments of exercise51.launch.py of unit5_pkg:\n\n    'speed':\n"
    assert result.tools.started == []


def test_a_program_that_fails_gives_its_status(packages: Packages) -> None:
    result = carry_out("run unit5_pkg exercise51", packages=packages, exit_status=3)
    assert (result.out, result.status) == ("[ros2run]: Process exited with failure 3\n", 3)


def test_an_interrupt_goes_to_the_program_and_its_end_is_waited_for(packages: Packages) -> None:
    result = carry_out("run unit5_pkg exercise51", packages=packages, exit_status=None, interrupt_at=2.0)
    (program,) = result.tools.programs
    assert program.interrupted == 1
    assert result.status == 130


@pytest.mark.parametrize(
    ("line", "complaint"),
    [
        ("run unit6_pkg x", "Package 'unit6_pkg' not found"),
        ("run unit5_pkg x", "No executable found: 'x' in package 'unit5_pkg'; known executables: callback_groups_"),  # noqa: E501
        ("run --prefix gdb unit5_pkg exercise51", "ros2 run --prefix is not supported here"),
        ("launch unit6_pkg x.launch.py", "Package 'unit6_pkg' not found"),
        ("launch unit5_pkg x.launch.py", "file 'x.launch.py' was not found in the share directory of package"),  # noqa: E501
        ("launch x.launch.py", "'x.launch.py' is not a launch file; one of a package needs the package's name"),  # noqa: E501
        ("launch unit5_pkg exercise51.launch.py a=b", "malformed launch argument 'a=b', expected format"),
        ("launch unit5_pkg exercise51.launch.py -p", "ros2 launch --print is not supported here"),
        ("pkg prefix unit6_pkg", "Package 'unit6_pkg' not found"),
        ("pkg create --build-type ament_python unit5_pkg --dependencies rclpy std_msgs", "ros2 pkg create is not carried out here"),  # noqa: E501
    ],
)  # fmt: skip
def test_a_wrong_line_says_what_is_wrong(line: str, complaint: str, packages: Packages) -> None:
    result = carry_out(line, packages=packages)
    assert result.err.startswith(complaint)
    assert (result.err.count("\n"), result.status) == (1, 1)
    assert result.tools.started == []


def test_packages_are_listed_with_what_they_hold(packages: Packages) -> None:
    assert carry_out("pkg list", packages=packages).out == "unit5_pkg\n"
    assert carry_out("pkg executables", packages=packages).out == (
        "unit5_pkg callback_groups_examples\nunit5_pkg exercise51\n"
    )
    assert carry_out("pkg executables --full-path unit5_pkg", packages=packages).out.endswith(
        "/exercise51.py\n"
    )
    assert carry_out("pkg xml unit5_pkg -t version", packages=packages).out == "0.1.0\n"
    assert carry_out("pkg prefix --share unit5_pkg", packages=packages).out.endswith("/share/unit5_pkg\n")
