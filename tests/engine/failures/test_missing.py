"""What is said of modules that are not here."""

import sys

import pytest

from sim.engine.failures.missing import on_missing
from sim.interfaces import packages

PIP = "pip install {}, into the Python that runs cbtui"


@pytest.mark.parametrize(
    ("module", "advice"),
    [
        ("cv2", PIP.format("opencv-python")),
        ("serial", PIP.format("pyserial")),
        ("PIL.Image", PIP.format("pillow")),
        ("sklearn", PIP.format("scikit-learn")),
        ("matplotlib", PIP.format("matplotlib")),
        ("scipy", PIP.format("scipy")),
        ("can", PIP.format("python-can")),
        ("rospy", "rospy is a package of ROS 1; in ROS 2, rclpy takes its place"),
        ("actionlib", "actionlib is a package of ROS 1; in ROS 2, rclpy.action has ActionClient"),
        ("xacro", "xacro belongs to a ROS 2 machine and is not modelled here; "),
        ("PyKDL", "PyKDL belongs to a ROS 2 machine and is not modelled here; tf2_geometry_msgs transforms"),
        ("tf", "tf is a package of ROS 1; in ROS 2, tf2_ros takes its place"),
        (
            "moveit_py",
            "moveit_py belongs to a ROS 2 machine and is not modelled here; planning needs MoveIt's",
        ),
        ("ros2topic.api", "ros2topic belongs to a ROS 2 machine and is not modelled here; the lines of ros2"),
        ("py_trees", PIP.format("py_trees")),
        (
            "rclcpp_components",
            "rclcpp_components belongs to a ROS 2 machine and is not modelled here; components are C++;",
        ),
        ("tf2_roos", "did you mean 'tf2_ros'?"),
        ("sim.world", "sim is a package of cbtui's own, which hides yours; rename yours"),
        (
            "moveit_msgs",
            "moveit_msgs is a package of interfaces that is not here; copy its definitions into ",
        ),
        ("my_robot_msgs", "ros2 interface packages lists those that are here; your own are found beside"),
        ("geometry_msg", "did you mean 'geometry_msgs'?"),
        ("sensr_msgs", "did you mean 'sensor_msgs'?"),
        ("rclpi", "did you mean 'rclpy'?"),
        ("std_srvs.msg", "std_srvs has services only"),
        ("frobnicate", "frobnicate is neither beside the file, nor in its workspace, nor installed; "),
    ],
)
def test_a_module_that_is_missing_is_told_by_what_it_is(
    module: str, advice: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delitem(sys.modules, module.partition(".")[0], raising=False)
    said = on_missing(module)
    assert said.startswith(advice)
    assert len(said) < 160


@pytest.mark.parametrize(
    "package",
    [
        *("moveit_msgs", "frob_msgs", "my_msgs", "robot_msgs", "foo_msgs", "apriltag_msgs"),
        *("tutorial_interfaces", "custom_interfaces", "robot_interfaces", "more_interfaces"),
    ],
)
def test_an_ending_that_packages_share_does_not_make_them_alike(package: str) -> None:
    assert "did you mean" not in on_missing(package)
    assert package not in packages()
