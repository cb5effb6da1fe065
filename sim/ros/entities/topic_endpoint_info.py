"""The graph's information on one publisher or subscription."""

from collections.abc import Callable, Mapping
from enum import IntEnum
from typing import Any

from sim.ros.middleware.type_hash import TypeHash
from sim.ros.qos.qos import QoSHistoryPolicy, QoSPresetProfiles, QoSProfile


class TopicEndpointTypeEnum(IntEnum):
    """The kind of an endpoint."""

    INVALID = 0
    PUBLISHER = 1
    SUBSCRIPTION = 2


class TopicEndpointInfo:
    """Information on a publisher or subscription. Every value is checked when it is set.

    ``topic_type_hash`` and ``qos_profile`` may be dictionaries of keyword arguments.

    Raises:
        AssertionError: there is no such field, or a value has the wrong type.
        ValueError: there is no such kind of endpoint.
    """

    __slots__ = (
        "endpoint_gid",
        "endpoint_type",
        "node_name",
        "node_namespace",
        "qos_profile",
        "topic_type",
        "topic_type_hash",
    )

    node_name: str
    node_namespace: str
    topic_type: str
    topic_type_hash: TypeHash
    endpoint_type: TopicEndpointTypeEnum
    endpoint_gid: list[int]
    qos_profile: QoSProfile

    def __init__(self, **values: Any) -> None:
        assert values.keys() <= _DEFAULTS.keys(), (
            f"Invalid arguments passed to constructor: {values.keys()!r}"
        )
        for name, default in _DEFAULTS.items():
            setattr(self, name, values[name] if name in values else default())

    def __setattr__(self, name: str, value: Any) -> None:
        object.__setattr__(self, name, _CHECKS[name](value) if name in _CHECKS else value)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, TopicEndpointInfo):
            return False
        return all(getattr(self, name) == getattr(other, name) for name in _DEFAULTS)

    __hash__ = None  # type: ignore[assignment]

    def __str__(self) -> str:
        qos = self.qos_profile
        history = qos.history.name
        if qos.history == QoSHistoryPolicy.KEEP_LAST:
            history += f" ({qos.depth})"
        return (
            f"Node name: {self.node_name}\n"
            f"Node namespace: {self.node_namespace}\n"
            f"Topic type: {self.topic_type}\n"
            f"Topic type hash: {self.topic_type_hash}\n"
            f"Endpoint type: {self.endpoint_type.name}\n"
            f"GID: {'.'.join(format(each, '02x') for each in self.endpoint_gid)}\n"
            "QoS profile:\n"
            f"  Reliability: {qos.reliability.name}\n"
            f"  History (Depth): {history}\n"
            f"  Durability: {qos.durability.name}\n"
            f"  Lifespan: {qos.lifespan}\n"
            f"  Deadline: {qos.deadline}\n"
            f"  Liveliness: {qos.liveliness.name}\n"
            f"  Liveliness lease duration: {qos.liveliness_lease_duration}"
        )


def _text(value: Any) -> str:
    assert isinstance(value, str)
    return value


def _endpoint_type(value: Any) -> TopicEndpointTypeEnum:
    assert isinstance(value, int)
    return TopicEndpointTypeEnum(value)


def _gid(value: Any) -> list[int]:
    assert all(isinstance(each, int) for each in value)
    return list(value)


def _type_hash(value: Any) -> TypeHash:
    assert isinstance(value, TypeHash | dict)
    return value if isinstance(value, TypeHash) else TypeHash(**value)


def _qos_profile(value: Any) -> QoSProfile:
    assert isinstance(value, QoSProfile | dict)
    return value if isinstance(value, QoSProfile) else QoSProfile(**value)


_DEFAULTS: Mapping[str, Callable[[], Any]] = {
    "node_name": str,
    "node_namespace": str,
    "topic_type": str,
    "topic_type_hash": TypeHash,
    "endpoint_type": lambda: TopicEndpointTypeEnum.INVALID,
    "endpoint_gid": list,
    "qos_profile": lambda: QoSPresetProfiles.UNKNOWN.value,
}
_CHECKS: Mapping[str, Callable[[Any], Any]] = {
    "node_name": _text,
    "node_namespace": _text,
    "topic_type": _text,
    "topic_type_hash": _type_hash,
    "endpoint_type": _endpoint_type,
    "endpoint_gid": _gid,
    "qos_profile": _qos_profile,
}
