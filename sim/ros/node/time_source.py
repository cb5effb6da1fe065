"""The time source of a node's clocks: the run's clock, or ``/clock`` with ``use_sim_time``."""

from __future__ import annotations

import weakref
from typing import TYPE_CHECKING, Any

from sim.interfaces import message, rcl_interfaces
from sim.ros.clocks.clock import Clock, ROSClock
from sim.ros.entities.subscription import Subscription
from sim.ros.node.kept_times import KeptTimes
from sim.ros.parameters.parameter import Parameter
from sim.ros.qos.qos import QoSProfile, ReliabilityPolicy
from sim.ros.scheduling.entity import OwnerNode
from sim.ros.time.clock_type import ClockType
from sim.ros.time.time import Time

if TYPE_CHECKING:
    from sim.ros.node.node import Node

CLOCK_TOPIC = "/clock"
USE_SIM_TIME_NAME = "use_sim_time"


class TimeSource:
    """Sets the attached clocks to the time of ``/clock`` while ROS time is active.

    The node declares ``use_sim_time``, and follows it at the start and whenever it is set. As in rclpy, the
    subscription of ``/clock`` is in the node's default group: a callback that holds the group stops ROS time.
    """

    def __init__(self, *, node: Node | None = None) -> None:
        self._clock_sub: Subscription | None = None
        self._node_weak_ref: weakref.ref[Node] | None = None
        self._associated_clocks: list[ROSClock] = []
        self._last_time_set = Time(clock_type=ClockType.ROS_TIME)
        self._ros_time_is_active = False
        self._kept = KeptTimes()
        if node is not None:
            self.attach_node(node)

    @property
    def ros_time_is_active(self) -> bool:
        """Whether the clocks follow ``/clock``; can be set."""
        return self._ros_time_is_active

    @ros_time_is_active.setter
    def ros_time_is_active(self, enabled: bool) -> None:
        if self._ros_time_is_active == enabled:
            return
        self._ros_time_is_active = enabled
        for clock in self._associated_clocks:
            clock._set_ros_time_is_active(enabled)
        if enabled:
            self._subscribe_to_clock_topic()
        else:
            self._unsubscribe()

    def attach_node(self, node: Node) -> None:
        """Subscribe to ``/clock`` through a node, and follow its ``use_sim_time``.

        Raises:
            TypeError: the object is not a node.
        """
        if not isinstance(node, OwnerNode):
            raise TypeError("Node must be of type rclpy.node.Node")
        if self._node_weak_ref is not None:
            self.detach_node()
        self._node_weak_ref = weakref.ref(node)
        self._logger = node.get_logger()
        if not node.has_parameter(USE_SIM_TIME_NAME):
            node.declare_parameter(USE_SIM_TIME_NAME, False)
        parameter = node.get_parameter(USE_SIM_TIME_NAME)
        if parameter.type_ is Parameter.Type.BOOL:
            self.ros_time_is_active = parameter.value
            if self._ros_time_is_active:
                self._subscribe_to_clock_topic()
        else:
            self._logger.error(
                f"Invalid type for parameter '{USE_SIM_TIME_NAME}' {parameter.type_!r} should be bool"
            )
        node.add_on_set_parameters_callback(self._on_set)

    def detach_node(self) -> None:
        """Unsubscribe from ``/clock``; RuntimeError if the node with the subscription is gone."""
        if self._clock_sub is not None and self._get_node() is None:
            raise RuntimeError("Unable to destroy previously created clock subscription")
        self._unsubscribe()
        self._clock_sub = None
        self._node_weak_ref = None

    def attach_clock(self, clock: Clock) -> None:
        """Set a clock of ROS time now to the last received time, and later to each new one.

        Raises:
            ValueError: the clock has another type.
        """
        if not isinstance(clock, ROSClock):
            raise ValueError("Only clocks with type ROS_TIME can be attached.")  # noqa: TRY004 -- rclpy's
        clock.set_ros_time_override(self._last_time_set)
        clock._set_ros_time_is_active(self._ros_time_is_active)
        if clock not in self._associated_clocks:
            self._associated_clocks.append(clock)

    def clock_callback(self, msg: Any) -> None:
        """Set the clocks to the time of a rosgraph_msgs/msg/Clock."""
        node, before = self._get_node(), self._last_time_set.nanoseconds
        self._last_time_set = Time.from_msg(msg.clock)
        now = self._last_time_set.nanoseconds
        if node is not None and now < before:
            self._kept.jumps_back(node, before, now)
        for clock in self._associated_clocks:
            clock.set_ros_time_override(self._last_time_set)
        names = [] if node is None else self._kept.still_kept(node, now)
        if node is not None and names:
            node.context.probe.times_kept(node.trace_id, self._kept.length, names)

    def _subscribe_to_clock_topic(self) -> None:
        node = self._get_node()
        if self._clock_sub is None and node is not None:
            self._clock_sub = node.create_subscription(
                message("rosgraph_msgs", "Clock"),
                CLOCK_TOPIC,
                self.clock_callback,
                QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT),
            )

    def _unsubscribe(self) -> None:
        node = self._get_node()
        if self._clock_sub is not None and node is not None:
            node.destroy_subscription(self._clock_sub)
            self._clock_sub = None

    def _get_node(self) -> Node | None:
        return None if self._node_weak_ref is None else self._node_weak_ref()

    def _on_set(self, parameters: list[Parameter[Any]]) -> Any:
        for parameter in parameters:
            if parameter.name != USE_SIM_TIME_NAME:
                continue
            if parameter.type_ is not Parameter.Type.BOOL:
                reason = f"{USE_SIM_TIME_NAME} parameter set to something besides a bool"
                self._logger.error(reason)
                return rcl_interfaces.SetParametersResult(successful=False, reason=reason)
            self.ros_time_is_active = parameter.value
        return rcl_interfaces.SetParametersResult(successful=True)
