"""``tf2_sensor_msgs``: importing it makes buffers transform point clouds."""

from sim.ros_packages.tf2_sensor_msgs.tf2_sensor_msgs import *
