"""``rclpy.type_description_service``, as programs import it."""

from sim.ros.node.type_description_service import *
