"""``rclpy.lifecycle.managed_entity``, as programs import it."""

from sim.ros.lifecycle.managed_entity import *
