"""``rclpy.action.server``, as programs import it."""

from sim.ros.actions.server import *
from sim.ros.actions.waitable import await_or_execute
from sim.ros.qos.qos import QoSProfile, qos_profile_action_status_default, qos_profile_services_default
from sim.ros.scheduling.waitable import NumberOfEntities
