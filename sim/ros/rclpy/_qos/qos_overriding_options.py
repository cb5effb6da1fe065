"""``rclpy.qos_overriding_options``, as programs import it."""

from sim.interfaces.rcl_interfaces import SetParametersResult as QosCallbackResult
from sim.ros.node.qos_overriding_options import *
from sim.ros.node.qos_overriding_options import _declare_qos_parameters as _declare_qos_parameters
from sim.ros.node.qos_overriding_options import _get_qos_policy_parameter as _get_qos_policy_parameter
