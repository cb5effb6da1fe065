"""Advice on a module that cannot be found: what it is, and where it comes from."""

import pkgutil
import sys
from collections.abc import Iterable
from difflib import get_close_matches

from sim.engine.failures.missing_names import on_hidden
from sim.interfaces import kinds_sentence, packages
from sim.ros.importing import HOMES
from sim.ros.rclpy._namesakes import NAMESAKES, VALIDATORS

_PIP = {
    "Crypto": "pycryptodome",
    "OpenGL": "PyOpenGL",
    "PIL": "pillow",
    "RPi": "RPi.GPIO",
    "bs4": "beautifulsoup4",
    "can": "python-can",
    "cv2": "opencv-python",
    "dateutil": "python-dateutil",
    "dotenv": "python-dotenv",
    "dt_apriltags": "dt-apriltags",
    "dynamixel_sdk": "dynamixel-sdk",
    "git": "GitPython",
    "paho": "paho-mqtt",
    "pupil_apriltags": "pupil-apriltags",
    "quaternion": "numpy-quaternion",
    "roboticstoolbox": "roboticstoolbox-python",
    "serial": "pyserial",
    "simple_pid": "simple-pid",
    "skimage": "scikit-image",
    "sklearn": "scikit-learn",
    "spatialmath": "spatialmath-python",
    "speech_recognition": "SpeechRecognition",
    "stable_baselines3": "stable-baselines3",
    "usb": "pyusb",
    "wx": "wxPython",
    "yaml": "pyyaml",
    "zmq": "pyzmq",
}
"""Modules of PyPI that robots' programs import, with the distribution that each comes in."""
_PIP_BY_NAME = """
    PyQt5 PySide6 casadi control cvxpy depthai filterpy flask gpiozero gymnasium keyboard matplotlib mediapipe
    networkx numba open3d pandas plotly py_trees pyaudio pygame pymavlink pynput pyproj pyrealsense2 requests
    scipy seaborn shapely smbus2 sympy tensorflow torch torchvision tqdm ultralytics utm websockets
""".split()  # noqa: SIM905 -- one name a line would be long
"""Modules whose distributions have the same name."""

_ROS_1 = {
    "actionlib": "rclpy.action has ActionClient and ActionServer",
    "catkin": "ament and colcon build packages",
    "catkin_pkg": "ament and colcon build packages",
    "dynamic_reconfigure": "nodes have parameters with callbacks, node.add_on_set_parameters_callback()",
    "genpy": "rclpy.serialization reads and writes messages",
    "move_base_msgs": "nav2_msgs has the action NavigateToPose",
    "moveit_commander": "moveit_py plans, on a ROS 2 machine",
    "rosbag": "cbtui run --record records, and ros2 bag on a ROS 2 machine",
    "roslaunch": "launch files are Python that imports launch and launch_ros",
    "roslib": "nothing takes its place, leave it out",
    "rosnode": "node.get_node_names() lists nodes",
    "rosparam": "node.declare_parameter() and node.get_parameter() handle parameters",
    "rospkg": "ament_index_python finds packages",
    "rospy": "rclpy takes its place",
    "rosservice": "node.get_service_names_and_types() lists services",
    "rostopic": "node.get_topic_names_and_types() lists topics",
    "smach": "py_trees takes its place",
    "tf": "tf2_ros takes its place, and tf_transformations that of tf.transformations",
}
"""Packages of ROS 1, with their replacement in ROS 2."""

_GEOMETRY = "tf2_geometry_msgs transforms messages, and tf_transformations has quaternions and matrices"
_PICTURES = "cv_bridge makes numpy arrays of sensor_msgs/msg/Image"
_TESTS = "test with pytest, where sim.ros.importing.install() makes rclpy importable"
_THERE = "run what needs it there"
_PLANNING = "planning needs MoveIt's own compiled libraries, and a robot's description"
_LINES = "the lines of ros2 that are known here run without it"
_ROS_2 = {
    "PyKDL": _GEOMETRY,
    "diagnostic_updater": "publish diagnostic_msgs/msg/DiagnosticArray on /diagnostics",
    "image_geometry": _PICTURES,
    "image_transport": _PICTURES,
    "launch_param_builder": _THERE,
    "launch_pytest": _TESTS,
    "launch_testing": _TESTS,
    "launch_testing_ros": _TESTS,
    "laser_geometry": "a few lines of math or numpy turn ranges into points",
    "moveit": _PLANNING,
    "moveit_configs_utils": _PLANNING,
    "moveit_py": _PLANNING,
    "nav2_common": _THERE,
    "nav2_simple_commander": "send the goals with rclpy.action.ActionClient",
    "py_trees_ros": _THERE,
    "rclcpp": "nodes are Python here, with rclpy",
    "rclcpp_components": "components are C++; a launch file starts nodes in Python, a process each",
    **dict.fromkeys(("ros2action", "ros2bag", "ros2cli", "ros2launch", "ros2node", "ros2param"), _LINES),
    **dict.fromkeys(("ros2pkg", "ros2run", "ros2service", "ros2topic"), _LINES),
    "rqt_gui": _THERE,
    "rqt_gui_py": _THERE,
    "tf2_kdl": _GEOMETRY,
    "turtle_tf2_py": "send the turtles' poses with tf2_ros.TransformBroadcaster",
    "urdf_parser_py": _THERE,
    "xacro": "give robot_description as URDF",
}
"""Python packages of ROS 2 that are not modelled, with a replacement."""

_INTERFACES = """
    apriltag_msgs aruco_msgs autoware_msgs cartographer_ros_msgs controller_manager_msgs
    crazyflie_interfaces foxglove_msgs gps_msgs grid_map_msgs irobot_create_msgs
    mavros_msgs moveit_msgs nmea_msgs novatel_gps_msgs object_recognition_msgs octomap_msgs
    pcl_msgs px4_msgs radar_msgs robot_localization ros_gz_interfaces rtcm_msgs slam_toolbox turtlebot3_msgs
    ublox_msgs ur_msgs velodyne_msgs webots_ros2_msgs
""".split()  # noqa: SIM905 -- as above
"""Packages of interfaces by other publishers, which cbtui does not have."""

_HERE = "into the Python that runs cbtui"
_OWN = "your own are found beside the file or in its workspace, as {0}/msg/Name.msg"
_KNOWN = {
    **{name: f"pip install {distribution}, {_HERE}" for name, distribution in _PIP.items()},
    **{name: f"pip install {name}, {_HERE}" for name in _PIP_BY_NAME},
    **{name: f"{name} is a package of ROS 1; in ROS 2, {there}" for name, there in _ROS_1.items()},
    **{
        name: f"{name} belongs to a ROS 2 machine and is not modelled here; {instead}"
        for name, instead in _ROS_2.items()
    },
    **{
        name: f"{name} is a package of interfaces that is not here; copy its definitions into the workspace, "
        f"as {name}/msg/Name.msg"
        for name in _INTERFACES
    },
}


def on_missing(module: str) -> str:
    """Return advice on a module that cannot be imported, as a clause."""
    package = module.partition(".")[0]
    if hidden := on_hidden(package):
        return hidden
    if package in packages():
        return kinds_sentence(package)
    if package in sys.modules:
        parent = sys.modules.get(module.rpartition(".")[0])
        folder = module.rpartition(".")[0]
        siblings = [each.name for each in pkgutil.iter_modules(getattr(parent, "__path__", ()))]
        siblings += (*NAMESAKES, *VALIDATORS) if folder == "rclpy" else ()
        return _nearest(module, (f"{folder}.{each}" for each in siblings))
    known = {*packages(), *sys.stdlib_module_names, *_KNOWN, *HOMES, "launch", "launch_ros", "numpy"}
    return _KNOWN.get(package) or _nearest(package, known) or _on_unknown(package)


def _on_unknown(package: str) -> str:
    if package.endswith(("_msgs", "_msg", "_srvs", "_interfaces", "_actions")):
        return f"ros2 interface packages lists those that are here; {_OWN.format(package)}"
    return (
        f"{package} is neither beside the file, nor in its workspace, nor installed; "
        f"what comes from PyPI is installed with pip, {_HERE}"
    )


def _nearest(name: str, known: Iterable[str]) -> str:
    """Return advice on a likely typing error; a common ending such as ``_msgs`` is not counted."""
    stems = {_stem(each): each for each in known if not each.startswith("_")}
    close = get_close_matches(_stem(name), stems, n=1, cutoff=0.75)
    return f"did you mean {stems[close[0]]!r}?" if close else ""


def _stem(name: str) -> str:
    return name.removesuffix("s").removesuffix("_msg").removesuffix("_interface")
