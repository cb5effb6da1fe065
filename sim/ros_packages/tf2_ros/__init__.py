"""``tf2_ros``: receives, sends and looks up transforms."""

from sim.ros_packages.tf2_py import *
from sim.ros_packages.tf2_ros.buffer import Buffer
from sim.ros_packages.tf2_ros.buffer_interface import (
    BufferInterface,
    ConvertRegistration,
    NotImplementedException,
    Stamped,
    TransformRegistration,
    TypeException,
    convert,
)
from sim.ros_packages.tf2_ros.static_transform_broadcaster import StaticTransformBroadcaster
from sim.ros_packages.tf2_ros.transform_broadcaster import TransformBroadcaster
from sim.ros_packages.tf2_ros.transform_listener import TransformListener
