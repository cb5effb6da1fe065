"""A console that follows this process: what it is told, and what it is too slow for."""

from __future__ import annotations

import json
import time
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import socket
    from collections.abc import Sequence

_UNSENT = 1 << 24
"""Bytes that wait for a slow console; what comes beyond them is lost to it, and counted."""
_BATCH = 500
"""Events of one line at most."""

_encode = json.JSONEncoder(separators=(",", ":"), check_circular=False).encode


class Console:
    """One that follows, by its connection. For one thread; nothing blocks."""

    def __init__(self, connection: socket.socket) -> None:
        self._connection = connection
        self._unsent = bytearray()
        self._lost = 0
        self._lost_told = 0

    @property
    def is_up_to_date(self) -> bool:
        """Whether it has been sent all that it was told."""
        return not self._unsent

    def tell(self, told: bytes, count: int) -> None:
        """Tell it of so many events, as lines."""
        if len(self._unsent) + len(told) > _UNSENT:
            self._lost += count
        else:
            self._unsent += told

    def tell_lost(self, lost: int) -> None:
        """Tell it how many events it will never get, those included that this process lost for everybody."""
        lost += self._lost
        if lost > self._lost_told and len(self._unsent) < _UNSENT // 2:
            self._lost_told = lost
            self._unsent += lines([("lost", time.monotonic_ns(), lost)])

    def send(self) -> bool:
        """Send what it takes now; returns whether it is still there."""
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
        """Leave it."""
        self._connection.close()


def lines(events: Sequence[tuple[Any, ...]]) -> bytes:
    """Lines of JSON, each an array of events: one event at a time takes three times as long."""
    batches = (events[start : start + _BATCH] for start in range(0, len(events), _BATCH))
    return b"".join(_encode(batch).encode() + b"\n" for batch in batches)
