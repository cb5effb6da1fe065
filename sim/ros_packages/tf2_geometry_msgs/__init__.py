"""``tf2_geometry_msgs``: importing it makes buffers transform points, vectors and poses."""

from sim.ros_packages.tf2_geometry_msgs.tf2_geometry_msgs import *
