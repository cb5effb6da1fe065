"""The send buffer of a connected console: bounded, and never blocking."""

from __future__ import annotations

import json
import time
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import socket
    from collections.abc import Sequence

_UNSENT = 1 << 24
"""The most bytes buffered for a slow console; further events are dropped for it, and counted."""
_BATCH = 500
"""The most events in one line."""

_encode = json.JSONEncoder(separators=(",", ":"), check_circular=False).encode


class Console:
    """A connected console. Not thread-safe; nothing blocks."""

    def __init__(self, connection: socket.socket) -> None:
        self._connection = connection
        self._unsent = bytearray()
        self._lost = 0
        self._lost_told = 0

    @property
    def is_up_to_date(self) -> bool:
        """Whether the buffer is empty."""
        return not self._unsent

    def tell(self, told: bytes, count: int) -> None:
        """Buffer the lines of so many events."""
        if len(self._unsent) + len(told) > _UNSENT:
            self._lost += count
        else:
            self._unsent += told

    def tell_lost(self, lost: int) -> None:
        """Report how many events were dropped, including the ``lost`` ones that no console gets."""
        lost += self._lost
        if lost > self._lost_told and len(self._unsent) < _UNSENT // 2:
            self._lost_told = lost
            self._unsent += lines([("lost", time.monotonic_ns(), lost)])

    def send(self) -> bool:
        """Send what the socket accepts now; returns whether the console is still connected."""
        try:
            while self._unsent:
                del self._unsent[: self._connection.send(self._unsent)]
        except BlockingIOError:
            return True
        except OSError:
            self.close()
            return False
        return True

    def close(self) -> None:
        """Close the connection."""
        self._connection.close()


def lines(events: Sequence[tuple[Any, ...]]) -> bytes:
    """Encode events as lines of JSON, each an array: encoding single events takes three times as long."""
    batches = (events[start : start + _BATCH] for start in range(0, len(events), _BATCH))
    return b"".join(_encode(batch).encode() + b"\n" for batch in batches)
