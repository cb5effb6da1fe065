"""``rclpy.action.client``, as programs import it."""

from sim.ros.actions.client import *
from sim.ros.actions.waitable import await_or_execute
from sim.ros.qos.qos import QoSProfile, qos_profile_action_status_default, qos_profile_services_default
