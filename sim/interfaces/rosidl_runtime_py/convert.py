"""Messages as dictionaries, YAML and CSV; mirrors ``rosidl_runtime_py.convert``.

Only what rosidl's messages have is used, so that these can be converted, too.
"""

from array import array
from collections import OrderedDict
from functools import partial
from typing import Any, TypeGuard

import numpy as np

from sim.files import plain_yaml
from sim.interfaces.base import Message
from sim.interfaces.field_types import FieldType, SequenceType

_COLLECTIONS = (list, tuple, array, np.ndarray)


def message_to_ordereddict(
    msg: Message, *, truncate_length: int | None = None, no_arr: bool = False, no_str: bool = False
) -> OrderedDict[str, Any]:
    """Return a message as a dictionary of plain values.

    Sequences and texts longer than ``truncate_length`` are shortened and end in ``...``. ``no_arr`` and
    ``no_str`` replace sequences and texts by their type and length.
    """
    plain = partial(_plain, truncate_length=truncate_length, no_arr=no_arr, no_str=no_str)
    return OrderedDict((name, plain(getattr(msg, name), of)) for name, of in field_types(msg).items())


def message_to_yaml(
    msg: Message,
    *,
    truncate_length: int | None = None,
    no_arr: bool = False,
    no_str: bool = False,
    flow_style: bool = False,
) -> str:
    """Return a message as YAML, on one line if ``flow_style``; the rest as `message_to_ordereddict`."""
    values = message_to_ordereddict(msg, truncate_length=truncate_length, no_arr=no_arr, no_str=no_str)
    return plain_yaml.dump(values, flow_style=flow_style)


def message_to_csv(
    msg: Message, *, truncate_length: int | None = None, no_arr: bool = False, no_str: bool = False
) -> str:
    """Return the values of a message and of its nested messages, separated by commas."""

    def written(value: Any, of: FieldType | None = None) -> str:
        if isinstance(value, _COLLECTIONS):
            if no_arr and of is not None and is_nested(of):
                return _length_of(value, of)
            shown = len(value) if truncate_length is None else truncate_length
            items = [written(item) for item in value[:shown]]
            return ",".join([*items, "..."] if len(value) > shown else items)
        if hasattr(value, "SLOT_TYPES"):
            return message_to_csv(value, truncate_length=truncate_length, no_arr=no_arr, no_str=no_str)
        if isinstance(value, str | bytes):
            if no_str:
                return f"<string length: <{len(value)}>>"
            return str(_shortened(value, truncate_length))
        return str(value)

    return ",".join(written(getattr(msg, name), of) for name, of in field_types(msg).items())


def get_message_slot_types(msg: Message | type[Message]) -> OrderedDict[str, FieldType]:
    """Return the type of every field by slot: ``{"_data": BasicType("int32")}``."""
    return OrderedDict((f"_{name}", of) for name, of in field_types(msg).items())


def field_types(msg: Message | type[Message]) -> dict[str, FieldType]:
    """Return the type of every field by its name."""
    return dict(zip(msg.get_fields_and_field_types(), msg.SLOT_TYPES, strict=True))


def is_nested(of: FieldType) -> TypeGuard[SequenceType]:
    """Whether this is the type of an array or sequence."""
    return hasattr(of, "value_type")


def _plain(
    value: Any, of: FieldType | None, *, truncate_length: int | None, no_arr: bool, no_str: bool
) -> Any:
    options: dict[str, Any] = {"truncate_length": truncate_length, "no_arr": no_arr, "no_str": no_str}
    if hasattr(value, "SLOT_TYPES"):
        return message_to_ordereddict(value, **options)
    if isinstance(value, _COLLECTIONS):
        if no_arr and of is not None and is_nested(of):
            return _length_of(value, of)
        shown = len(value) if truncate_length is None else truncate_length
        items = [_plain(item, None, **options) for item in value[:shown]]
        return [*items, "..."] if len(value) > shown else items
    if isinstance(value, bytes):
        return str(_shortened(value.decode("latin-1"), truncate_length))
    if isinstance(value, str):
        return f"<string length: <{len(value)}>>" if no_str else _shortened(value, truncate_length)
    return value.item() if isinstance(value, np.generic) else value


def _shortened(value: str | bytes, length: int | None) -> str | bytes:
    if length is None or len(value) <= length:
        return value
    return value[:length] + "..." if isinstance(value, str) else value[:length] + b"..."


def _length_of(value: Any, of: SequenceType) -> str:
    """Return the type and length of a sequence, which replace its values."""
    inner: Any = of.value_type
    if hasattr(inner, "namespaced_name"):
        name = "/".join(inner.namespaced_name())
    else:
        name = getattr(inner, "typename", "wstring" if "WString" in type(inner).__name__ else "string")
    size: int | None = getattr(of, "size", None)
    if size is not None:
        return f"<array type: {name}[{size}]>"
    bound = f"[{of.maximum_size}]" if hasattr(of, "maximum_size") else ""
    return f"<sequence type: {name}{bound}, length: {len(value)}>"
