"""``tf2_geometry_msgs``: its import registers points, vectors and poses with all buffers."""

from sim.ros_packages.tf2_geometry_msgs.tf2_geometry_msgs import *
