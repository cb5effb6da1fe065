"""``rclpy.service``, as programs import it."""

from sim.ros.entities.service import *
