"""``rclpy.qos``, as programs import it."""

from sim.ros.qos.qos import *
from sim.ros.time.duration import Duration
