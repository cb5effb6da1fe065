"""What is said of packages that are missing on real ROS 2."""

import pkgutil
import sys
from pathlib import Path

import pytest

import sim.ros_packages
from cbtui.commands.options import changes
from sim.real.missing import on_missing


@pytest.mark.parametrize(
    ("package", "name"),
    [
        ("tf2_ros", "ros-jazzy-tf2-ros-py"),
        ("tf2_geometry_msgs", "ros-jazzy-tf2-geometry-msgs"),
        ("tf_transformations", "ros-jazzy-tf-transformations"),
        ("message_filters", "ros-jazzy-message-filters"),
        ("cv_bridge", "ros-jazzy-cv-bridge"),
        ("sensor_msgs_py.point_cloud2", "ros-jazzy-sensor-msgs-py"),
        ("rosbag2_py", "ros-jazzy-rosbag2-py"),
        ("launch", "ros-jazzy-launch"),
        ("nav2_msgs.action", "ros-jazzy-nav2-msgs"),
    ],
)
def test_what_only_an_installed_ros_has_is_told_with_its_name_there(package: str, name: str) -> None:
    said = on_missing(f"ModuleNotFoundError: No module named '{package}'", "")
    assert f"PyPI has no wheel of {package.partition('.')[0]}: " in said
    assert said.endswith(f"sudo apt install {name}")


@pytest.mark.parametrize("package", [each.name for each in pkgutil.iter_modules(sim.ros_packages.__path__)])
def test_every_package_that_the_model_has_is_known(package: str) -> None:
    assert on_missing(f"ModuleNotFoundError: No module named '{package}'", "")


def test_what_has_wheels_is_installed_with_pip() -> None:
    said = on_missing("ModuleNotFoundError: No module named 'nav_msgs'", "kilted")
    assert said == "pip install ros-kilted-nav-msgs, into the Python that runs it"


@pytest.mark.parametrize("other", ["ModuleNotFoundError: No module named 'mine'", "KeyError: 'tf2_ros'", ""])
def test_nothing_is_said_of_others(other: str) -> None:
    assert on_missing(other, "") == ""


def test_the_wheels_of_two_releases_in_one_python_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("rclpy", "ros_lyrical_rclpy-10.0.dist-info", "ros_rolling_rclpy-11.0.dist-info"):
        (tmp_path / name).mkdir()
    for folder in tmp_path.glob("*.dist-info"):
        (folder / "METADATA").write_text(f"Name: {folder.name.partition('-')[0].replace('_', '-')}\n")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    with pytest.raises(changes.NoRealRosError, match="lyrical and rolling, which have overwritten"):
        changes.real_ros(sys.executable)
