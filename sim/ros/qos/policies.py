"""The QoS policies, with the values of ROS 2."""

from enum import IntEnum


class QoSPolicyKind(IntEnum):
    """The kinds of policies in a profile."""

    INVALID = 1 << 0
    DURABILITY = 1 << 1
    DEADLINE = 1 << 2
    LIVELINESS = 1 << 3
    RELIABILITY = 1 << 4
    HISTORY = 1 << 5
    LIFESPAN = 1 << 6
    DEPTH = 1 << 7
    LIVELINESS_LEASE_DURATION = 1 << 8
    AVOID_ROS_NAMESPACE_CONVENTIONS = 1 << 9


def qos_policy_name_from_kind(policy_kind: QoSPolicyKind | int) -> str:
    """The name of a kind of policy."""
    return QoSPolicyKind(policy_kind).name


class QoSPolicyEnum(IntEnum):
    """Base of the policies with named values."""

    @property
    def short_key(self) -> str:
        """The value's name in lower case, as on the command line."""
        return self.name.lower()

    @classmethod
    def short_keys(cls) -> list[str]:
        """The short names of all values."""
        return [each.short_key for each in cls]

    @classmethod
    def get_from_short_key(cls, name: str) -> int:
        """The value of a short name; KeyError for an unknown one."""
        return int(cls[name.upper()])


class HistoryPolicy(QoSPolicyEnum):
    """Whether a queue keeps the last messages or all."""

    SYSTEM_DEFAULT = 0
    KEEP_LAST = 1
    KEEP_ALL = 2
    UNKNOWN = 3
    RMW_QOS_POLICY_HISTORY_SYSTEM_DEFAULT = SYSTEM_DEFAULT
    RMW_QOS_POLICY_HISTORY_KEEP_LAST = KEEP_LAST
    RMW_QOS_POLICY_HISTORY_KEEP_ALL = KEEP_ALL
    RMW_QOS_POLICY_HISTORY_UNKNOWN = UNKNOWN


class ReliabilityPolicy(QoSPolicyEnum):
    """Whether a lost message is sent again."""

    SYSTEM_DEFAULT = 0
    RELIABLE = 1
    BEST_EFFORT = 2
    UNKNOWN = 3
    BEST_AVAILABLE = 4
    RMW_QOS_POLICY_RELIABILITY_SYSTEM_DEFAULT = SYSTEM_DEFAULT
    RMW_QOS_POLICY_RELIABILITY_RELIABLE = RELIABLE
    RMW_QOS_POLICY_RELIABILITY_BEST_EFFORT = BEST_EFFORT
    RMW_QOS_POLICY_RELIABILITY_UNKNOWN = UNKNOWN


class DurabilityPolicy(QoSPolicyEnum):
    """Whether a late subscription gets earlier messages."""

    SYSTEM_DEFAULT = 0
    TRANSIENT_LOCAL = 1
    VOLATILE = 2
    UNKNOWN = 3
    BEST_AVAILABLE = 4
    RMW_QOS_POLICY_DURABILITY_SYSTEM_DEFAULT = SYSTEM_DEFAULT
    RMW_QOS_POLICY_DURABILITY_TRANSIENT_LOCAL = TRANSIENT_LOCAL
    RMW_QOS_POLICY_DURABILITY_VOLATILE = VOLATILE
    RMW_QOS_POLICY_DURABILITY_UNKNOWN = UNKNOWN


class LivelinessPolicy(QoSPolicyEnum):
    """How a publisher asserts its liveliness."""

    SYSTEM_DEFAULT = 0
    AUTOMATIC = 1
    MANUAL_BY_TOPIC = 3
    UNKNOWN = 4
    BEST_AVAILABLE = 5
    RMW_QOS_POLICY_LIVELINESS_SYSTEM_DEFAULT = SYSTEM_DEFAULT
    RMW_QOS_POLICY_LIVELINESS_AUTOMATIC = AUTOMATIC
    RMW_QOS_POLICY_LIVELINESS_MANUAL_BY_TOPIC = MANUAL_BY_TOPIC
    RMW_QOS_POLICY_LIVELINESS_UNKNOWN = UNKNOWN
