"""The compatibility of offered and requested QoS profiles.

Source: the ROS 2 documentation, "QoS compatibilities".
"""

from __future__ import annotations

from collections.abc import Iterator
from enum import IntEnum
from typing import TYPE_CHECKING, NamedTuple

from sim.ros.qos.policies import DurabilityPolicy, LivelinessPolicy, QoSPolicyEnum, ReliabilityPolicy
from sim.ros.time.duration import Duration, Infinite

if TYPE_CHECKING:
    from sim.ros.qos.qos import QoSProfile


class QoSCompatibility(IntEnum):
    """Whether two profiles are compatible: yes, perhaps, no."""

    OK = 0
    WARNING = 1
    ERROR = 2


class _Mismatch(NamedTuple):
    policy: str
    text: str


def mismatches(offered: QoSProfile, requested: QoSProfile) -> Iterator[str]:
    """Yield the names of the incompatible policies."""
    for each in _errors(offered, requested):
        yield each.policy


def qos_check_compatible(
    publisher_qos: QoSProfile, subscription_qos: QoSProfile
) -> tuple[QoSCompatibility, str]:
    """Whether the profiles of a publisher and a subscription are compatible, and the reason if not.

    WARNING if that is unknown, because one profile leaves a policy to the system.
    """
    texts = [f"ERROR: {each.text};" for each in _errors(publisher_qos, subscription_qos)]
    if texts:
        return QoSCompatibility.ERROR, "".join(texts)
    texts = [f"WARNING: {each};" for each in _doubts(publisher_qos, subscription_qos)]
    return (QoSCompatibility.WARNING if texts else QoSCompatibility.OK), "".join(texts)


def _errors(offered: QoSProfile, requested: QoSProfile) -> Iterator[_Mismatch]:
    if (offered.reliability, requested.reliability) == (
        ReliabilityPolicy.BEST_EFFORT,
        ReliabilityPolicy.RELIABLE,
    ):
        yield _Mismatch("RELIABILITY", "Best effort publisher and reliable subscription")
    if (offered.durability, requested.durability) == (
        DurabilityPolicy.VOLATILE,
        DurabilityPolicy.TRANSIENT_LOCAL,
    ):
        yield _Mismatch("DURABILITY", "Volatile publisher and transient local subscription")
    if (text := _slower(offered.deadline, requested.deadline, "deadline")) is not None:
        yield _Mismatch("DEADLINE", text)
    if offered.liveliness != requested.liveliness == LivelinessPolicy.MANUAL_BY_TOPIC and (
        offered.liveliness in {LivelinessPolicy.AUTOMATIC, LivelinessPolicy.SYSTEM_DEFAULT}
    ):
        yield _Mismatch(
            "LIVELINESS", "Publisher's liveliness is automatic and subscription's is manual by topic"
        )
    lease, wanted = offered.liveliness_lease_duration, requested.liveliness_lease_duration
    if (text := _slower(lease, wanted, "liveliness lease duration")) is not None:
        yield _Mismatch("LIVELINESS", text)


def _slower(offered: Duration, requested: Duration, what: str) -> str | None:
    if not _limited(requested):
        return None
    if not _limited(offered):
        return f"Subscription has a {what}, but publisher does not"
    if requested < offered:
        return f"Subscription {what} is less than publisher {what}"
    return None


def _limited(duration: Duration) -> bool:
    return Duration() < duration < Infinite


def _doubts(offered: QoSProfile, requested: QoSProfile) -> Iterator[str]:
    for name in ("reliability", "durability", "liveliness"):
        publishers: QoSPolicyEnum = getattr(offered, name)
        subscriptions: QoSPolicyEnum = getattr(requested, name)
        if {publishers.name, subscriptions.name} & {"SYSTEM_DEFAULT", "UNKNOWN"} and not (
            name == "liveliness" and publishers == subscriptions == LivelinessPolicy.SYSTEM_DEFAULT
        ):
            yield (
                f"Publisher's {name} is {_words(publishers)} and subscription's is {_words(subscriptions)}"
            )


def _words(policy: QoSPolicyEnum) -> str:
    return policy.short_key.replace("_", " ")
