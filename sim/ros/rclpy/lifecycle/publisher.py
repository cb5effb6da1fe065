"""``rclpy.lifecycle.publisher``, as programs import it."""

from sim.ros.lifecycle.publisher import *
