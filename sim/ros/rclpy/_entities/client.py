"""``rclpy.client``, as programs import it."""

from sim.ros.entities.client import *
