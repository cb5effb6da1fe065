"""``rclpy.service_introspection``, as programs import it."""

from sim.ros.entities.service_introspection import *
