"""Lets a task of asyncio await a future of rclpy."""

from __future__ import annotations

import inspect
import sys
from collections.abc import Callable, Generator
from types import FrameType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from asyncio import AbstractEventLoop, Future

_SUSPENDABLE = inspect.CO_COROUTINE | inspect.CO_GENERATOR | inspect.CO_ASYNC_GENERATOR


def driven_by_asyncio() -> bool:
    """Whether asyncio, not an executor, runs the awaiting coroutine; to be called inside ``__await__``."""
    if "asyncio" not in sys.modules:
        return False
    frame: FrameType | None = sys._getframe(1)
    while frame is not None and frame.f_code.co_flags & _SUSPENDABLE:
        frame = frame.f_back
    return frame is not None and str(frame.f_globals.get("__name__", "")).startswith("asyncio.")


def wait_in_asyncio(wake_when_done: Callable[[AsyncioWaiter], None]) -> Generator[Any, None, None]:
    """Suspend the running asyncio task until the future that has this ``wake_when_done`` is done."""
    import asyncio

    loop = asyncio.get_running_loop()
    waiter: Future[None] = loop.create_future()
    wake_when_done(AsyncioWaiter(loop, waiter))
    yield from waiter


class AsyncioWaiter:
    """A task of asyncio that waits for a future of rclpy."""

    def __init__(self, loop: AbstractEventLoop, waiter: Future[None]) -> None:
        self._loop = loop
        self._waiter = waiter

    def _resume_soon(self) -> None:
        if not self._loop.is_closed():
            self._loop.call_soon_threadsafe(self._release)

    def _release(self) -> None:
        if not self._waiter.done():
            self._waiter.set_result(None)
