"""``message_filters.simple_filter``: the base of filters."""

from collections.abc import Callable
from typing import Any


class SimpleFilter:
    """Calls the registered callbacks with each output."""

    def __init__(self) -> None:
        self.callbacks: dict[int, tuple[Callable[..., Any], tuple[Any, ...]]] = {}

    def registerCallback(self, cb: Callable[..., Any], *args: Any) -> int:
        """Call ``cb`` with each output and ``args``; return the number of the connection."""
        connection = len(self.callbacks)
        self.callbacks[connection] = (cb, args)
        return connection

    def unregisterCallback(self, conn: int) -> None:
        """Remove the callback of a connection."""
        self.callbacks.pop(conn, None)

    def signalMessage(self, *msg: Any) -> None:
        """Call the callbacks with messages."""
        for callback, arguments in tuple(self.callbacks.values()):
            callback(*msg, *arguments)
