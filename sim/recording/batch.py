"""Encodes events as ROS messages of a recording, on a topic that other readers of MCAP can ignore.

A batch of events, packed as for the pipe, is one message of ``/cbtui/events``.
"""

import struct

import msgspec

from sim.trace.events import AnyEvent, decode, encode

FORMAT = 1
"""The version of the format, raised when older versions could not read a change."""
TOPIC = "/cbtui/events"
TYPE = "cbtui_msgs/msg/EventBatch"
PARTICIPANTS = "application/x-cbtui-events"
"""The media type of attachments with a copy of the events that introduce the participants."""
DEFINITION = "uint32 version\nuint8[] events\n"

_MOST = 16_000_000
"""Bytes that a batch may have; decoded, its events take many times as much memory."""
_LITTLE_ENDIAN_CDR = b"\x00\x01\x00\x00"
_HEAD = struct.Struct("<4sII")


class BatchError(Exception):
    """The bytes are not a batch of events."""


class NewerFormatError(Exception):
    """A batch in the format of a later version of cbtui."""

    def __init__(self, version: int) -> None:
        super().__init__(f"format {version}")
        self.version = version


def pack_batch(events: list[AnyEvent]) -> bytes:
    """Encode a batch as a message in CDR."""
    packed = encode(events)
    return _HEAD.pack(_LITTLE_ENDIAN_CDR, FORMAT, len(packed)) + packed


def unpack_batch(data: bytes) -> list[AnyEvent]:
    """Decode what ``pack_batch`` encoded.

    Raises:
        NewerFormatError: a later version packed it.
        BatchError: the bytes are something else.
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
