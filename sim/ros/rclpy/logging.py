"""``rclpy.logging``, as programs import it."""

from sim.ros.logging.logger import *
from sim.ros.logging.logger import _root_logger as _root_logger
