"""``rclpy.executors``, as programs import it."""

from sim.ros.context.context import Context
from sim.ros.context.utilities import get_default_context
from sim.ros.scheduling.executors import *
from sim.ros.scheduling.task import Future
