"""Overrides of a topic's QoS by parameters."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from sim.interfaces import rcl_interfaces
from sim.ros.entities.publisher import Publisher
from sim.ros.entities.subscription import Subscription
from sim.ros.exceptions import ParameterAlreadyDeclaredException
from sim.ros.qos.policies import QoSPolicyEnum
from sim.ros.qos.qos import QoSPolicyKind, QoSProfile
from sim.ros.time.duration import Duration

if TYPE_CHECKING:
    from sim.ros.node.node import Node


class InvalidQosOverridesError(Exception):
    """The program's callback refused an overridden profile."""

    __module__ = "rclpy.qos_overriding_options"


class QoSOverridingOptions:
    """Which policies may be overridden.

    ``callback`` gets the overridden profile and returns a SetParametersResult; ``entity_id`` distinguishes
    several publishers or subscriptions of one topic.
    """

    def __init__(
        self,
        policy_kinds: Iterable[QoSPolicyKind],
        *,
        callback: Callable[[QoSProfile], Any] | None = None,
        entity_id: str | None = None,
    ) -> None:
        self._policy_kinds = tuple(policy_kinds)
        self._callback = callback
        self._entity_id = entity_id

    @property
    def policy_kinds(self) -> Iterable[QoSPolicyKind]:
        """The policies that may be overridden."""
        return self._policy_kinds

    @property
    def callback(self) -> Callable[[QoSProfile], Any] | None:
        """The callback that accepts or refuses the overridden profile."""
        return self._callback

    @property
    def entity_id(self) -> str | None:
        """The id that distinguishes several endpoints of one topic."""
        return self._entity_id

    @classmethod
    def with_default_policies(
        cls, *, callback: Callable[[QoSProfile], Any] | None = None, entity_id: str | None = None
    ) -> QoSOverridingOptions:
        """Options that allow overrides of history, depth and reliability."""
        kinds = (QoSPolicyKind.HISTORY, QoSPolicyKind.DEPTH, QoSPolicyKind.RELIABILITY)
        return cls(kinds, callback=callback, entity_id=entity_id)


def overridden(
    entity_type: type[Publisher | Subscription],
    node: Node,
    topic: str,
    qos: QoSProfile,
    options: QoSOverridingOptions,
) -> QoSProfile:
    """A profile with the values of ``qos_overrides.<topic>.<entity>.<policy>``, which are declared here.

    Raises:
        InvalidQosOverridesError: the options' callback refuses the profile.
    """
    changed = replace(qos)
    _declare_qos_parameters(entity_type, node, topic, changed, options)
    return changed


def _declare_qos_parameters(
    entity_type: type[Publisher | Subscription],
    node: Node,
    topic_name: str,
    qos: QoSProfile,
    options: QoSOverridingOptions,
) -> None:
    """Declare the parameters, and set the policies of ``qos``. The name is rclpy's."""
    from sim.ros.entities.publisher import Publisher

    entity = "publisher" if issubclass(entity_type, Publisher) else "subscription"
    suffix = f"_{options.entity_id}" if options.entity_id else ""
    for kind in options.policy_kinds:
        policy = kind.name.lower()
        name = f"qos_overrides.{topic_name}.{entity}{suffix}.{policy}"
        value = _declared(node, name, _get_qos_policy_parameter(qos, kind))
        setattr(qos, policy, _as_policy(getattr(qos, policy), value))
    if options.callback is not None:
        verdict = options.callback(qos)
        if not verdict.successful:
            raise InvalidQosOverridesError(
                f"{entity} {{{topic_name}}}: Provided QoS overrides `{qos}`, are not valid: {verdict.reason}"
            )


def _declared(node: Node, name: str, value: Any) -> Any:
    descriptor = rcl_interfaces.ParameterDescriptor(read_only=True)
    try:
        return node.declare_parameter(name, value, descriptor).value
    except ParameterAlreadyDeclaredException:
        return node.get_parameter(name).value


def _get_qos_policy_parameter(qos: QoSProfile, policy_kind: QoSPolicyKind) -> bool | int | str:
    """The value of a policy as a parameter. The name is rclpy's."""
    policy: Any = getattr(qos, policy_kind.name.lower())
    if isinstance(policy, QoSPolicyEnum):
        return policy.short_key
    if isinstance(policy, Duration):
        return policy.nanoseconds
    assert isinstance(policy, bool | int)
    return policy


def _as_policy(former: Any, value: Any) -> Any:
    if isinstance(former, QoSPolicyEnum):
        return type(former).get_from_short_key(value)
    return Duration(nanoseconds=value) if isinstance(former, Duration) else value
