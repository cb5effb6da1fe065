"""``rclpy.clock``, as programs import it."""

from sim.ros.clocks.clock import *
from sim.ros.exceptions import NotInitializedException
from sim.ros.time.duration import Duration
from sim.ros.time.time import Time
