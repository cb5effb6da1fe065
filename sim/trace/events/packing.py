"""Packs events as MessagePack for the pipe and for files."""

from functools import cache, reduce
from operator import or_
from typing import Any

import msgspec

from sim.trace.events.event import TraceEvent, kinds

_encoder = msgspec.msgpack.Encoder()


def encode(events: list[TraceEvent]) -> bytes:
    """Pack a batch of events."""
    try:
        return _encoder.encode(events)
    except UnicodeEncodeError:
        return _encoder.encode(escape_surrogates(events))


def escape_surrogates(events: list[TraceEvent]) -> list[TraceEvent]:
    r"""Return events with the lone surrogates in their texts written as ``\udc80``: UTF-8 cannot encode them.

    They come from file names that are not UTF-8, and from what programs print.
    """
    return [_escaped(event) for event in events]


def _escaped(value: Any) -> Any:
    match value:
        case str():
            return value.encode(errors="backslashreplace").decode()
        case tuple():
            return tuple(map(_escaped, value))
        case msgspec.Struct():
            texts = {name: _escaped(getattr(value, name)) for name in value.__struct_fields__}
            return msgspec.structs.replace(value, **texts)
    return value


def decode(batch: bytes) -> list[TraceEvent]:
    """Unpack what ``encode`` packed.

    Raises:
        msgspec.DecodeError: the bytes are not a batch of events.
    """
    try:
        return _decoder().decode(batch)
    except (UnicodeDecodeError, RecursionError) as error:
        raise msgspec.DecodeError(f"the bytes are no events: {error}") from None


@cache
def _decoder() -> msgspec.msgpack.Decoder[list[TraceEvent]]:
    event: Any = reduce(or_, kinds())
    return msgspec.msgpack.Decoder(list[event])
