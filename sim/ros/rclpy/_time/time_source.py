"""``rclpy.time_source``, as programs import it."""

from sim.ros.node.time_source import *
