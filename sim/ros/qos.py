"""Quality of service: how many messages are kept, and which publishers a subscription can hear."""

from collections.abc import Iterator
from dataclasses import dataclass, fields
from enum import IntEnum
from typing import Any

from sim.ros.duration import Duration


class InvalidQoSProfileException(Exception):
    """A quality of service that contradicts itself."""

    def __init__(self, *args: object) -> None:
        super().__init__("Invalid QoSProfile", *args)


class _Policy(IntEnum):
    @property
    def short_key(self) -> str:
        """The policy's name in lower case, as the command line writes it."""
        return self.name.lower()

    @classmethod
    def short_keys(cls) -> list[str]:
        """Every short name of the policy."""
        return [each.short_key for each in cls if each.name != "UNKNOWN"]

    @classmethod
    def get_from_short_key(cls, name: str) -> int:
        """The value of a policy's short name; KeyError for an unknown one."""
        return int(cls[name.upper()])


class HistoryPolicy(_Policy):
    """What a full queue does."""

    SYSTEM_DEFAULT = 0
    KEEP_LAST = 1
    KEEP_ALL = 2
    UNKNOWN = 3


class ReliabilityPolicy(_Policy):
    """Whether a lost message is sent again."""

    SYSTEM_DEFAULT = 0
    RELIABLE = 1
    BEST_EFFORT = 2
    UNKNOWN = 3
    BEST_AVAILABLE = 4


class DurabilityPolicy(_Policy):
    """Whether a late subscription gets what was published before it."""

    SYSTEM_DEFAULT = 0
    TRANSIENT_LOCAL = 1
    VOLATILE = 2
    UNKNOWN = 3
    BEST_AVAILABLE = 4


class LivelinessPolicy(_Policy):
    """How a publisher shows that it lives."""

    SYSTEM_DEFAULT = 0
    AUTOMATIC = 1
    MANUAL_BY_TOPIC = 3
    UNKNOWN = 4
    BEST_AVAILABLE = 5


QoSHistoryPolicy = HistoryPolicy
QoSReliabilityPolicy = ReliabilityPolicy
QoSDurabilityPolicy = DurabilityPolicy
QoSLivelinessPolicy = LivelinessPolicy


_UNSPECIFIED = Duration()


@dataclass(slots=True, init=False)
class QoSProfile:
    """How a publisher, subscription, service or client treats its messages.

    Raises:
        InvalidQoSProfileException: neither a history nor a depth is given, or KEEP_LAST without a depth.
    """

    history: HistoryPolicy = HistoryPolicy.KEEP_LAST
    depth: int = 0
    reliability: ReliabilityPolicy = ReliabilityPolicy.RELIABLE
    durability: DurabilityPolicy = DurabilityPolicy.VOLATILE
    lifespan: Duration = _UNSPECIFIED
    deadline: Duration = _UNSPECIFIED
    liveliness: LivelinessPolicy = LivelinessPolicy.SYSTEM_DEFAULT
    liveliness_lease_duration: Duration = _UNSPECIFIED
    avoid_ros_namespace_conventions: bool = False

    def __init__(self, **settings: Any) -> None:
        known = {each.name for each in fields(QoSProfile)}
        if unknown := sorted(set(settings) - known):
            raise TypeError(f"Invalid arguments for QoSProfile: {', '.join(unknown)}")
        if "history" not in settings:
            if "depth" not in settings:
                raise InvalidQoSProfileException("History and/or depth settings are required.")
            settings["history"] = HistoryPolicy.KEEP_LAST
        if settings["history"] == HistoryPolicy.KEEP_LAST and "depth" not in settings:
            raise InvalidQoSProfileException("History set to KEEP_LAST without a depth setting.")
        if not isinstance(settings.get("depth", 0), int) or settings.get("depth", 0) < 0:
            raise ValueError("depth must be an integer of 0 or more")
        for name, default in _DEFAULTS.items():
            setattr(self, name, settings.get(name, default))
        self.history = HistoryPolicy(self.history)
        self.reliability = ReliabilityPolicy(self.reliability)
        self.durability = DurabilityPolicy(self.durability)

    @property
    def queue_length(self) -> int | None:
        """How many messages a queue keeps; None for all of them. A depth of 0 keeps one, as DDS does."""
        return None if self.history == HistoryPolicy.KEEP_ALL else max(self.depth, 1)


_DEFAULTS: dict[str, Any] = {
    "history": HistoryPolicy.KEEP_LAST,
    "depth": 0,
    "reliability": ReliabilityPolicy.RELIABLE,
    "durability": DurabilityPolicy.VOLATILE,
    "lifespan": _UNSPECIFIED,
    "deadline": _UNSPECIFIED,
    "liveliness": LivelinessPolicy.SYSTEM_DEFAULT,
    "liveliness_lease_duration": _UNSPECIFIED,
    "avoid_ros_namespace_conventions": False,
}

qos_profile_default = QoSProfile(depth=10)
qos_profile_system_default = QoSProfile(
    history=HistoryPolicy.SYSTEM_DEFAULT,
    reliability=ReliabilityPolicy.SYSTEM_DEFAULT,
    durability=DurabilityPolicy.SYSTEM_DEFAULT,
)
qos_profile_sensor_data = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
qos_profile_services_default = QoSProfile(depth=10)
qos_profile_parameters = QoSProfile(depth=1000)
qos_profile_parameter_events = QoSProfile(depth=1000)
qos_profile_best_available = QoSProfile(
    depth=10,
    reliability=ReliabilityPolicy.BEST_AVAILABLE,
    durability=DurabilityPolicy.BEST_AVAILABLE,
    liveliness=LivelinessPolicy.BEST_AVAILABLE,
)


def as_profile(qos: QoSProfile | int) -> QoSProfile:
    """A profile as it is; a number as the depth of a default profile.

    Raises:
        TypeError: it is neither.
        ValueError: the depth is negative.
    """
    if isinstance(qos, QoSProfile):
        return qos
    if isinstance(qos, int) and not isinstance(qos, bool):
        if qos < 0:
            raise ValueError("depth must be an integer of 0 or more")
        return QoSProfile(depth=qos)
    raise TypeError(f"Expected QoSProfile or int, but received {type(qos)!r}")


def mismatches(offered: QoSProfile, requested: QoSProfile) -> Iterator[str]:
    """Name the policies by which a subscription cannot hear a publisher; nothing: they match.

    Source: the ROS 2 documentation, "QoS compatibilities" (requested versus offered).
    """
    if (
        requested.reliability == ReliabilityPolicy.RELIABLE
        and offered.reliability == ReliabilityPolicy.BEST_EFFORT
    ):
        yield "RELIABILITY"
    if (
        requested.durability == DurabilityPolicy.TRANSIENT_LOCAL
        and offered.durability == DurabilityPolicy.VOLATILE
    ):
        yield "DURABILITY"
