"""Advice on a name that a package of ROS 2 has and its model lacks."""

import re

_HOME = re.compile(r"\bsim\.(?:ros|ros_packages|interfaces|launch)\.")

_RECORD = (
    "cbtui run --record records all topics, and a subscription with serialize_message() and a "
    "SequentialWriter records one"
)
_PLAY = "read with a SequentialReader, and publish in a timer what deserialize_message() makes of it"
_BAGS = "ros2 bag does it on a ROS 2 machine"
_SERVED = "give the node a Buffer and a TransformListener of its own"
_INDEX = "packages are read from sources; ament_index_python.packages finds them and their files"
_MISSING = (
    ("tf2_ros", "BufferClient", f"it asks a buffer_server, which is a program in C++; {_SERVED}"),
    ("tf2_ros", "BufferServer", f"only C++ has it; {_SERVED}"),
    ("tf2_ros", "MessageFilter", "only C++ has it; await buffer.wait_for_transform_async() in the callback"),
    (
        "tf2_ros",
        "StaticTransformListener",
        "Jazzy has none; a TransformListener hears static ones, too",
    ),
    ("message_filters", "InputAligner", "an ApproximateTimeSynchronizer brings several topics together"),
    ("message_filters", "Synchronizer", "only C++ has it; Python has TimeSynchronizer"),
    ("rosbag2_py", "Recorder RecordOptions", _RECORD),
    ("rosbag2_py", "Player PlayOptions ServiceRequestsSource", _PLAY),
    ("rosbag2_py", "Reindexer bag_rewrite", _BAGS),
    (
        "rosbag2_py",
        "SequentialCompressionWriter CompressionOptions CompressionMode",
        "SequentialWriter writes bags that are not compressed",
    ),
    (
        "rosbag2_py",
        "LocalMessageDefinitionSource convert_rclcpp_qos_to_rclpy_qos to_rclcpp_qos_vector",
        "bags are read and written without it",
    ),
    *(
        (f"ament_index_python{module}", names, _INDEX)
        for module in ("", ".resources", ".search_paths")
        for names in ("get_resource get_resources get_resource_types has_resource get_search_paths",)
    ),
    ("cv_bridge", "cvtColorForDisplay getCvType", "pip install opencv-python, and use cv2 on the arrays"),
    (
        "tf_transformations",
        "Arcball clip_matrix orthogonalization_matrix projection_from_matrix projection_matrix "
        "superimposition_matrix",
        "a few lines of numpy do it",
    ),
)
_FILTER = "content filters came with Kilted and are not modelled here; have the callback pass over messages"
_NEWER = {
    "configure_introspection": "introspection came with Kilted for actions and is not modelled here; "
    "ros2 topic echo /NAME/_action/feedback shows an action's progress",
    "content_filter_options": _FILTER,
    "get_content_filter": _FILTER,
    "is_cft_enabled": _FILTER,
    "rclpy.subscription_content_filter_options": _FILTER,
    "rosout_qos_profile": "Kilted lets a node choose the QoS of /rosout, which is not modelled; leave it out",
    "set_content_filter": _FILTER,
}
"""What Kilted's rclpy has and no release here: arguments, attributes and modules."""
_OURS = {"cbtui", "lessons", "sim"}
_INSTEAD = {f"{module}.{name}": instead for module, names, instead in _MISSING for name in names.split()}
"""The replacement of each missing name."""


def on_missing_name(module: str, name: str) -> str:
    """Return advice on a name that a module has in ROS 2 and lacks in the model, as a clause; else ""."""
    module = names_for_programs(module)
    whole = f"{module}.{name}"
    return f"{whole} is not modelled here; {_INSTEAD[whole]}" if whole in _INSTEAD else on_hidden(module)


def on_hidden(module: str) -> str:
    """Return advice on a program's own module that a package of cbtui's hides, as a clause; else ""."""
    package = module.partition(".")[0]
    return (
        f"{package} is a package of cbtui's own, which hides yours; rename yours" if package in _OURS else ""
    )


def on_newer(name: str) -> str:
    """What to do about an argument, attribute or module that came with Kilted; else empty."""
    return _NEWER.get(name, "")


def names_for_programs(text: str) -> str:
    """Return a text with module names as programs import them."""
    return _HOME.sub("", text)
