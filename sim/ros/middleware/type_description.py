"""Descriptions of message types as messages, and the hashes of ROS 2 for types.

Source: REP 2016 and rosidl's generator of type descriptions (RIHS01: the SHA-256 of the description as JSON).
"""

import json
from collections.abc import Iterator
from functools import cache
from hashlib import sha256
from typing import Any

from sim.interfaces import Message, message
from sim.interfaces.field_types import (
    Array,
    BasicType,
    BoundedSequence,
    BoundedString,
    BoundedWString,
    ElementType,
    FieldType,
    NamespacedType,
    UnboundedSequence,
    UnboundedString,
    element_type,
)
from sim.ros.middleware.type_hash import TypeHash

_PACKAGE = "type_description_interfaces"
_VERSION = 1
_FILLER = ("structure_needs_at_least_one_member", BasicType("uint8"))
"""The field that ROS 2's IDL adds to an empty type."""


@cache
def type_hash(msg_type: type[Message]) -> TypeHash:
    """The hash of a type and of all types that it contains. Thread-safe."""
    return TypeHash(_VERSION, sha256(json.dumps(_whole(msg_type)).encode()).digest())


def type_description(msg_type: type[Message]) -> Any:
    """A type_description_interfaces/msg/TypeDescription of a type and of all types that it contains."""
    whole = _whole(msg_type)
    return message(_PACKAGE, "TypeDescription")(
        type_description=_individual(whole["type_description"]),
        referenced_type_descriptions=[_individual(each) for each in whole["referenced_type_descriptions"]],
    )


def contained_types(msg_type: type[Message]) -> list[type[Message]]:
    """All types that a type contains, directly or indirectly, sorted by name."""
    found: dict[str, type[Message]] = {}
    waiting = [msg_type]
    while waiting:
        for part in waiting.pop().__interface__.parts.values():
            if part.__type_name__ not in found:
                found[part.__type_name__] = part
                waiting.append(part)
    return [found[name] for name in sorted(found)]


def _whole(msg_type: type[Message]) -> dict[str, Any]:
    return {
        "type_description": _struct(msg_type),
        "referenced_type_descriptions": [_struct(each) for each in contained_types(msg_type)],
    }


def _struct(msg_type: type[Message]) -> dict[str, Any]:
    return {"type_name": msg_type.__type_name__, "fields": list(_fields(msg_type))}


def _fields(msg_type: type[Message]) -> Iterator[dict[str, Any]]:
    for name, of in msg_type.__interface__.types.items() or (_FILLER,):
        yield {"name": name, "type": _field_type(of)}


def _field_type(of: FieldType) -> dict[str, Any]:
    element = element_type(of)
    suffix, capacity = _repetition(of)
    number: int = getattr(message(_PACKAGE, "FieldType"), f"FIELD_TYPE_{_constant(element)}{suffix}")
    return {
        "type_id": number,
        "capacity": capacity,
        "string_capacity": element.maximum_size if isinstance(element, BoundedString | BoundedWString) else 0,
        "nested_type_name": (
            "/".join(element.namespaced_name()) if isinstance(element, NamespacedType) else ""
        ),
    }


def _repetition(of: FieldType) -> tuple[str, int]:
    if isinstance(of, Array):
        return "_ARRAY", of.size
    if isinstance(of, BoundedSequence):
        return "_BOUNDED_SEQUENCE", of.maximum_size
    return ("_UNBOUNDED_SEQUENCE", 0) if isinstance(of, UnboundedSequence) else ("", 0)


def _constant(of: ElementType) -> str:
    if isinstance(of, NamespacedType):
        return "NESTED_TYPE"
    if isinstance(of, BasicType):
        return "BYTE" if of.typename == "octet" else of.typename.upper()
    if isinstance(of, BoundedString):
        return "BOUNDED_STRING"
    if isinstance(of, UnboundedString):
        return "STRING"
    return "BOUNDED_WSTRING" if isinstance(of, BoundedWString) else "WSTRING"


def _individual(struct: dict[str, Any]) -> Any:
    field, field_type = message(_PACKAGE, "Field"), message(_PACKAGE, "FieldType")
    return message(_PACKAGE, "IndividualTypeDescription")(
        type_name=struct["type_name"],
        fields=[
            field(name=each["name"], type=field_type(**each["type"]), default_value="")
            for each in struct["fields"]
        ],
    )
