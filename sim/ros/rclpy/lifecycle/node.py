"""``rclpy.lifecycle.node``, as programs import it."""

from sim.ros.lifecycle.node import *
