"""The profile of a publisher as other nodes see it, and as rosbag2 stores it."""

from copy import copy

from sim.ros.qos.qos import LivelinessPolicy, QoSProfile
from sim.ros.time.duration import Duration, Infinite

_SECOND = 1_000_000_000


def as_discovered(profile: QoSProfile) -> QoSProfile:
    """The profile that other nodes discover: unspecified policies have the defaults of DDS."""
    seen = copy(profile)
    for name in ("lifespan", "deadline", "liveliness_lease_duration"):
        if getattr(seen, name) == Duration():
            setattr(seen, name, Infinite)
    if seen.liveliness is LivelinessPolicy.SYSTEM_DEFAULT:
        seen.liveliness = LivelinessPolicy.AUTOMATIC
    return seen


def offered_qos_text(profile: QoSProfile) -> str:
    """The ``offered_qos_profiles`` of a topic with one publisher: YAML, in the form of rosbag2 metadata 9.

    Source: rosbag2_storage of Jazzy, whose enums are lower-case names and whose times are sec and nsec.
    """
    seen = as_discovered(profile)
    lines = [
        f"history: {seen.history.short_key}",
        f"depth: {seen.depth}",
        f"reliability: {seen.reliability.short_key}",
        f"durability: {seen.durability.short_key}",
        *_time("deadline", seen.deadline),
        *_time("lifespan", seen.lifespan),
        f"liveliness: {seen.liveliness.short_key}",
        *_time("liveliness_lease_duration", seen.liveliness_lease_duration),
        f"avoid_ros_namespace_conventions: {str(seen.avoid_ros_namespace_conventions).lower()}",
    ]
    return "- " + "\n  ".join(lines)


def _time(name: str, duration: Duration) -> list[str]:
    seconds, nanoseconds = divmod(duration.nanoseconds, _SECOND)
    return [f"{name}:", f"  sec: {seconds}", f"  nsec: {nanoseconds}"]
