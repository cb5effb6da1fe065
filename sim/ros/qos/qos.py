"""QoS profiles."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, fields
from enum import Enum
from typing import Any

from sim.ros.qos.compatibility import QoSCompatibility, mismatches, qos_check_compatible
from sim.ros.qos.policies import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSPolicyEnum,
    QoSPolicyKind,
    ReliabilityPolicy,
    qos_policy_name_from_kind,
)
from sim.ros.time.duration import Duration

__all__ = [
    "DurabilityPolicy",
    "HistoryPolicy",
    "InvalidQoSProfileException",
    "LivelinessPolicy",
    "QoSCompatibility",
    "QoSDurabilityPolicy",
    "QoSHistoryPolicy",
    "QoSLivelinessPolicy",
    "QoSPolicyEnum",
    "QoSPolicyKind",
    "QoSPresetProfiles",
    "QoSProfile",
    "QoSReliabilityPolicy",
    "RmwQoSProfile",
    "ReliabilityPolicy",
    "as_profile",
    "mismatches",
    "qos_check_compatible",
    "qos_policy_name_from_kind",
    "qos_profile_action_status_default",
    "qos_profile_best_available",
    "qos_profile_default",
    "qos_profile_parameter_events",
    "qos_profile_parameters",
    "qos_profile_sensor_data",
    "qos_profile_services_default",
    "qos_profile_system_default",
    "qos_profile_unknown",
]

QoSHistoryPolicy = HistoryPolicy
QoSReliabilityPolicy = ReliabilityPolicy
QoSDurabilityPolicy = DurabilityPolicy
QoSLivelinessPolicy = LivelinessPolicy


class InvalidQoSProfileException(Exception):
    """The settings of a profile contradict each other."""

    __module__ = "rclpy.qos"

    def __init__(self, *args: object) -> None:
        super().__init__("Invalid QoSProfile", *args)


_UNSPECIFIED = Duration()


@dataclass(slots=True, init=False)
class QoSProfile:
    """The QoS profile of a publisher, subscription, service or client.

    Raises:
        InvalidQoSProfileException: neither history nor depth is given, or KEEP_LAST without a depth.
        AssertionError: there is no such policy, or a value has the wrong type.
        ValueError: the depth is negative, or a policy has no such value.
    """

    history: HistoryPolicy = HistoryPolicy.KEEP_LAST
    depth: int = 10
    reliability: ReliabilityPolicy = ReliabilityPolicy.RELIABLE
    durability: DurabilityPolicy = DurabilityPolicy.VOLATILE
    lifespan: Duration = _UNSPECIFIED
    deadline: Duration = _UNSPECIFIED
    liveliness: LivelinessPolicy = LivelinessPolicy.SYSTEM_DEFAULT
    liveliness_lease_duration: Duration = _UNSPECIFIED
    avoid_ros_namespace_conventions: bool = False

    def __init__(self, **settings: Any) -> None:
        assert settings.keys() <= _DEFAULTS.keys(), (
            f"Invalid arguments passed to constructor: {settings.keys()!r}"
        )
        if "history" not in settings:
            if "depth" not in settings:
                raise InvalidQoSProfileException("History and/or depth settings are required.")
            settings["history"] = HistoryPolicy.KEEP_LAST
        if settings["history"] == HistoryPolicy.KEEP_LAST and "depth" not in settings:
            raise InvalidQoSProfileException("History set to KEEP_LAST without a depth setting.")
        for name, default in _DEFAULTS.items():
            setattr(self, name, settings.get(name, default))

    def __setattr__(self, name: str, value: Any) -> None:
        object.__setattr__(self, name, _CHECKS[name](value) if name in _CHECKS else value)
        if name == "depth" and value == 0 and self.history == HistoryPolicy.KEEP_LAST:
            warnings.warn(
                "A zero depth with KEEP_LAST doesn't make sense; no data could be stored. "
                "This will be interpreted as SYSTEM_DEFAULT",
                stacklevel=3,
            )

    def __str__(self) -> str:
        values = (f"{each.name}={getattr(self, each.name)}" for each in fields(self))
        return f"{type(self).__name__}({', '.join(values)})"

    def get_c_qos_profile(self) -> RmwQoSProfile:
        """Convert the profile to that of the layers below rclpy."""
        return RmwQoSProfile({each.name: getattr(self, each.name) for each in fields(self)})

    @property
    def queue_length(self) -> int | None:
        """The length of the queue; None: unlimited. As in DDS, a depth of 0 keeps one message."""
        return None if self.history == HistoryPolicy.KEEP_ALL else max(self.depth, 1)


@dataclass(frozen=True)
class RmwQoSProfile:
    """A profile of the layers below rclpy; ``QoSProfile(**profile.to_dict())`` converts it back."""

    settings: dict[str, Any]

    def to_dict(self) -> dict[str, Any]:
        """The settings, with policies as numbers."""
        return {
            name: int(value) if isinstance(value, QoSPolicyEnum) else value
            for name, value in self.settings.items()
        }


def _policy(kind: type[QoSPolicyEnum]) -> Any:
    def check(value: Any) -> QoSPolicyEnum:
        assert isinstance(value, int)
        return kind(value)

    return check


def _depth(value: Any) -> int:
    assert isinstance(value, int)
    if value < 0:
        raise ValueError("depth must be an integer of 0 or more")
    return value


def _duration(value: Any) -> Duration:
    assert isinstance(value, Duration)
    return value


def _truth(value: Any) -> bool:
    assert isinstance(value, bool)
    return value


_CHECKS: dict[str, Any] = {
    "history": _policy(HistoryPolicy),
    "depth": _depth,
    "reliability": _policy(ReliabilityPolicy),
    "durability": _policy(DurabilityPolicy),
    "lifespan": _duration,
    "deadline": _duration,
    "liveliness": _policy(LivelinessPolicy),
    "liveliness_lease_duration": _duration,
    "avoid_ros_namespace_conventions": _truth,
}
_DEFAULTS: dict[str, Any] = {each.name: each.default for each in fields(QoSProfile)}

qos_profile_unknown = QoSProfile(
    history=HistoryPolicy.UNKNOWN,
    depth=0,
    reliability=ReliabilityPolicy.UNKNOWN,
    durability=DurabilityPolicy.UNKNOWN,
    liveliness=LivelinessPolicy.UNKNOWN,
)
qos_profile_default = QoSProfile(depth=10)
qos_profile_system_default = QoSProfile(
    history=HistoryPolicy.SYSTEM_DEFAULT,
    depth=0,
    reliability=ReliabilityPolicy.SYSTEM_DEFAULT,
    durability=DurabilityPolicy.SYSTEM_DEFAULT,
)
qos_profile_sensor_data = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
qos_profile_services_default = QoSProfile(depth=10)
qos_profile_parameters = QoSProfile(depth=1000)
qos_profile_parameter_events = QoSProfile(depth=1000)
qos_profile_action_status_default = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
qos_profile_best_available = QoSProfile(
    depth=10,
    reliability=ReliabilityPolicy.BEST_AVAILABLE,
    durability=DurabilityPolicy.BEST_AVAILABLE,
    liveliness=LivelinessPolicy.BEST_AVAILABLE,
)


class QoSPresetProfiles(Enum):
    """ROS 2's predefined profiles; as in rclpy, equal profiles are aliases of the first one."""

    UNKNOWN = qos_profile_unknown
    DEFAULT = qos_profile_default
    SYSTEM_DEFAULT = qos_profile_system_default
    SENSOR_DATA = qos_profile_sensor_data
    SERVICES_DEFAULT = qos_profile_services_default
    PARAMETERS = qos_profile_parameters
    PARAMETER_EVENTS = qos_profile_parameter_events
    ACTION_STATUS_DEFAULT = qos_profile_action_status_default
    BEST_AVAILABLE = qos_profile_best_available

    @classmethod
    def short_keys(cls) -> list[str]:
        """The short names of all profiles."""
        return [name.lower() for name in cls.__members__]

    @classmethod
    def get_from_short_key(cls, name: str) -> QoSProfile:
        """The profile of a short name; KeyError for an unknown one."""
        found: QoSProfile = cls[name.upper()].value
        return found


def as_profile(qos: QoSProfile | int) -> QoSProfile:
    """A profile as it is; an int as the depth of a default profile.

    Raises:
        TypeError: it is neither a profile nor an int.
        ValueError: the depth is negative.
    """
    if isinstance(qos, QoSProfile):
        return qos
    if isinstance(qos, int) and not isinstance(qos, bool):
        if qos < 0:
            raise ValueError("history depth must be greater than or equal to zero")
        return QoSProfile(depth=qos)
    raise TypeError(f"Expected QoSProfile or int, but received {type(qos)!r}")
