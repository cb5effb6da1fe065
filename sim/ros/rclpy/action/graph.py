"""``rclpy.action.graph``, as programs import it."""

from sim.ros.actions.graph import *
