"""``rclpy.parameter``, as programs import it; rclpy's module uses the messages too."""

from sim.interfaces.rcl_interfaces import Parameter as ParameterMsg
from sim.interfaces.rcl_interfaces import ParameterType, ParameterValue
from sim.ros.parameters.parameter import *
