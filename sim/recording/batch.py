"""How events lie in a recording: as ROS messages of their own, which any reader of MCAP can pass over.

A batch of events, packed as for the pipe, is one message of ``/cbtui/events``.
"""

import struct

import msgspec

from sim.trace.events import AnyEvent, decode, encode

FORMAT = 1
"""The number that a change gets which older versions cannot read."""
TOPIC = "/cbtui/events"
TYPE = "cbtui_msgs/msg/EventBatch"
CAST = "application/x-cbtui-events"
"""The media type of the attachments that hold, once more, the events by which a run's parts appear."""
DEFINITION = "uint32 version\nuint8[] events\n"

_MOST = 16_000_000
"""Bytes that a batch may have; read, its events take many times as much memory."""
_LITTLE_ENDIAN_CDR = b"\x00\x01\x00\x00"
_HEAD = struct.Struct("<4sII")


class BatchError(Exception):
    """Bytes that are no batch of events."""


class NewerFormatError(Exception):
    """A batch in a format of a later version; ``version`` is its number."""

    def __init__(self, version: int) -> None:
        super().__init__(f"format {version}")
        self.version = version


def pack_batch(events: list[AnyEvent]) -> bytes:
    """A batch as the CDR of its message."""
    packed = encode(events)
    return _HEAD.pack(_LITTLE_ENDIAN_CDR, FORMAT, len(packed)) + packed


def unpack_batch(data: bytes) -> list[AnyEvent]:
    """What ``pack_batch`` packed.

    Raises:
        NewerFormatError: a later version packed it.
        BatchError: it is something else.
    """
    if not _HEAD.size <= len(data) <= _MOST:
        raise BatchError("too short or too long")
    encapsulation, version, length = _HEAD.unpack_from(data)
    if encapsulation != _LITTLE_ENDIAN_CDR:
        raise BatchError("no CDR")
    if version > FORMAT:
        raise NewerFormatError(version)
    if length != len(data) - _HEAD.size:
        raise BatchError("wrong length")
    try:
        return decode(data[_HEAD.size :])
    except msgspec.DecodeError as error:
        raise BatchError(str(error)) from None
