"""``tf2_sensor_msgs``: its import registers point clouds with all buffers."""

from sim.ros_packages.tf2_sensor_msgs.tf2_sensor_msgs import *
