"""Seals the batches of a trace: numbered, and with a keyed digest, so that a second writer is noticed.

A program shares the engine's process and can find the key there: a seal detects only other writers.
"""

import hashlib
import hmac
from itertools import count

import msgspec

_DIGEST_SIZE = 16


class BrokenSealError(Exception):
    """A batch that the engine did not send at this place; the text is a sentence."""


class TraceBatch(msgspec.Struct, frozen=True, array_like=True):
    """Encoded events, their place among a run's batches, and which functions of the engine were replaced."""

    number: int
    events: bytes
    replaced: tuple[str, ...] = ()


class _Sealed(msgspec.Struct, frozen=True, array_like=True):
    batch: bytes
    digest: bytes


class Seal:
    """Seals batches in order, or opens them in that order. ``key`` has up to 64 bytes."""

    def __init__(self, key: bytes) -> None:
        self._keyed = hashlib.blake2b(key=key, digest_size=_DIGEST_SIZE)
        self._numbers = count(1)

    def close(self, events: bytes, replaced: tuple[str, ...] = ()) -> bytes:
        """Return the next batch, sealed."""
        batch = msgspec.msgpack.encode(TraceBatch(next(self._numbers), events, replaced))
        return msgspec.msgpack.encode(_Sealed(batch, self._digest(batch)))

    def open(self, data: bytes) -> TraceBatch:
        """Return the next batch.

        Raises:
            BrokenSealError: the data was not sealed with the key, or is not the next batch.
        """
        try:
            sealed = msgspec.msgpack.decode(data, type=_Sealed)
        except msgspec.DecodeError:
            raise BrokenSealError("something without a seal was written to the trace") from None
        if not hmac.compare_digest(sealed.digest, self._digest(sealed.batch)):
            raise BrokenSealError("something with a wrong seal was written to the trace")
        batch = msgspec.msgpack.decode(sealed.batch, type=TraceBatch)
        expected = next(self._numbers)
        if batch.number != expected:
            raise BrokenSealError(f"batch {batch.number} of the trace came in place of {expected}")
        return batch

    def _digest(self, data: bytes) -> bytes:
        keyed = self._keyed.copy()
        keyed.update(data)
        return keyed.digest()
