"""Advice about a package that the model has and the real ROS 2 lacks."""

import re

from sim.interfaces import packages

_MISSING = re.compile(r"ModuleNotFoundError: No module named '(\w+)")
_PYTHON = """
    ament_index_python cv_bridge launch launch_ros message_filters rclpy rosbag2_py rosidl_runtime_py
    sensor_msgs_py tf2_geometry_msgs tf2_py tf2_ros tf2_sensor_msgs tf_transformations
""".split()  # noqa: SIM905 -- as below
"""Python packages; ``sim.interfaces`` knows those with message and service definitions."""
_WHEELS = """
    action_msgs ament_index_python builtin_interfaces diagnostic_msgs geometry_msgs lifecycle_msgs nav_msgs
    rcl_interfaces rclpy sensor_msgs std_msgs std_srvs stereo_msgs test_msgs trajectory_msgs
    type_description_interfaces visualization_msgs
""".split()  # noqa: SIM905 -- one to a line they would hide the rest
"""Packages that PyPI has; the others need an installed ROS 2."""
_DEBIAN = {"tf2_ros": "tf2-ros-py"}
"""Debian packages whose names differ from those of their modules."""


def on_missing(said: str, distribution: str) -> str:
    """Advice on an exception, given its class and text; empty if there is none."""
    found = _MISSING.search(said)
    package = found[1] if found else ""
    if package not in {*packages(), *_PYTHON}:
        return ""
    name = f"ros-{distribution or 'jazzy'}-{_DEBIAN.get(package, package.replace('_', '-'))}"
    if package in _WHEELS:
        return f"pip install {name}, into the Python that runs it"
    return (
        f"PyPI has no wheel of {package}: run without --on ros2, or with --python /usr/bin/python3 where "
        f"ROS 2 is installed, after sudo apt install {name}"
    )
