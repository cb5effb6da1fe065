"""``rclpy.serialization``, as programs import it."""

from sim.ros.entities.serialization import *
