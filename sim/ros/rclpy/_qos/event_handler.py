"""``rclpy.event_handler``, as programs import it."""

from sim.ros.entities.event_handler import *
