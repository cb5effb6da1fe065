"""``tf2_ros.buffer``: a buffer of transforms that can wait for them."""

import time as clock_of_the_run
from collections.abc import Callable
from functools import partial
from typing import Any

from rclpy.clock import Clock, JumpThreshold
from rclpy.duration import Duration
from rclpy.logging import get_logger
from rclpy.task import Future
from tf2_msgs.srv import FrameGraph

from sim.ros_packages.tf2_py.buffer_core import BufferCore
from sim.ros_packages.tf2_ros.buffer_interface import BufferInterface

__all__ = ["Buffer"]

_AT_ONCE = Duration()
_POLL_PERIOD = 0.02
"""Seconds between two polls of a waiting thread."""
_JUMPED = Duration(seconds=3.0)
"""If the clock goes back by more than this, it was set, and the wait ends."""


class Buffer(BufferCore, BufferInterface):
    """Transforms of the last 10 seconds, or of the last ``cache_time``.

    With a ``node``, the buffer is cleared when the node's clock is set back, and the node serves
    ``tf2_frames``.

    A wait polls every 0.02 s on the calling thread and runs no callbacks: inside a callback,
    transforms arrive only if another thread runs the listener's callbacks.
    """

    def __init__(self, cache_time: Any = None, node: Any = None) -> None:
        BufferCore.__init__(self, cache_time)
        BufferInterface.__init__(self)
        self._waiting: list[Callable[[], None]] = []
        if node is not None:
            self.srv = node.create_service(FrameGraph, "tf2_frames", self._answer_frames)
        self.clock = Clock() if node is None else node.get_clock()
        threshold = JumpThreshold(min_forward=None, min_backward=Duration(seconds=-1), on_clock_change=True)
        self.jump_handle = self.clock.create_jump_callback(threshold, post_callback=self.time_jump_callback)

    def time_jump_callback(self, time_jump: Any) -> None:
        """Clear the buffer: the clock was set back."""
        get_logger("tf2_buffer").warning("Detected jump back in time. Clearing tf buffer.")
        self.clear()

    def _answer_frames(self, _request: Any, response: Any) -> Any:
        response.frame_yaml = self.all_frames_as_yaml()
        return response

    def set_transform(self, transform: Any, authority: str) -> None:
        """Add a transform, and wake the waiting tasks."""
        super().set_transform(transform, authority)
        self._recheck()

    def set_transform_static(self, transform: Any, authority: str) -> None:
        """Add a static transform, and wake the waiting tasks."""
        super().set_transform_static(transform, authority)
        self._recheck()

    def _recheck(self) -> None:
        for check in tuple(self._waiting):
            check()

    def lookup_transform(
        self, target_frame: str, source_frame: str, time: Any, timeout: Any = _AT_ONCE
    ) -> Any:
        """The ``TransformStamped`` that converts data of ``source_frame`` to ``target_frame``.

        Time 0 means the latest common time. Waits for the transform on this thread, at most ``timeout``.

        Raises:
            LookupException, ConnectivityException, ExtrapolationException, InvalidArgumentException: as
                `BufferCore.lookup_transform_core`, after the timeout.
        """
        self.can_transform(target_frame, source_frame, time, timeout)
        return self.lookup_transform_core(target_frame, source_frame, time)

    async def lookup_transform_async(self, target_frame: str, source_frame: str, time: Any) -> Any:
        """As `lookup_transform`, awaiting the transform without a timeout."""
        await self.wait_for_transform_async(target_frame, source_frame, time)
        return self.lookup_transform_core(target_frame, source_frame, time)

    def lookup_transform_full(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
        timeout: Any = _AT_ONCE,
    ) -> Any:
        """As `lookup_transform`, from one time to another by way of a frame that is fixed meanwhile."""
        asked = (target_frame, target_time, source_frame, source_time, fixed_frame)
        self.can_transform_full(*asked, timeout)
        return self.lookup_transform_full_core(*asked)

    async def lookup_transform_full_async(
        self, target_frame: str, target_time: Any, source_frame: str, source_time: Any, fixed_frame: str
    ) -> Any:
        """As `lookup_transform_full`, awaiting the transform without a timeout."""
        asked = (target_frame, target_time, source_frame, source_time, fixed_frame)
        await self.wait_for_transform_full_async(*asked)
        return self.lookup_transform_full_core(*asked)

    def can_transform(
        self,
        target_frame: str,
        source_frame: str,
        time: Any,
        timeout: Any = _AT_ONCE,
        return_debug_tuple: bool = False,
    ) -> Any:
        """Whether there is a transform; waits for it on this thread, at most ``timeout``.

        With ``return_debug_tuple``, return the answer and the reason.
        """
        can = partial(self.can_transform_core, target_frame, source_frame, time)
        return _wait_until(can, timeout, return_debug_tuple)

    def can_transform_full(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
        timeout: Any = _AT_ONCE,
        return_debug_tuple: bool = False,
    ) -> Any:
        """As `can_transform`, from one time to another."""
        asked = (target_frame, target_time, source_frame, source_time, fixed_frame)
        return _wait_until(partial(self.can_transform_full_core, *asked), timeout, return_debug_tuple)

    def wait_for_transform_async(self, target_frame: str, source_frame: str, time: Any) -> Any:
        """A future of the transform, which is done as soon as the transform is available."""
        asked = (target_frame, source_frame, time)
        return self._await(
            partial(self.can_transform_core, *asked), partial(self.lookup_transform_core, *asked)
        )

    def wait_for_transform_full_async(
        self, target_frame: str, target_time: Any, source_frame: str, source_time: Any, fixed_frame: str
    ) -> Any:
        """As `wait_for_transform_async`, from one time to another."""
        asked = (target_frame, target_time, source_frame, source_time, fixed_frame)
        return self._await(
            partial(self.can_transform_full_core, *asked), partial(self.lookup_transform_full_core, *asked)
        )

    def _await(self, can: Callable[[], tuple[int, str]], look_up: Callable[[], Any]) -> Any:
        future = Future()

        def check() -> None:
            if future.done():
                return
            try:
                if can()[0]:
                    future.set_result(look_up())
            except Exception as error:  # noqa: BLE001 -- the awaiting task gets it
                future.set_exception(error)

        check()
        if not future.done():
            self._waiting.append(check)
            future.add_done_callback(lambda _: self._waiting.remove(check))
        return future


def _wait_until(can: Callable[[], tuple[int, str]], timeout: Any, with_reason: bool) -> Any:
    clock = Clock()
    begun = clock.now()
    while (
        timeout != _AT_ONCE
        and clock.now() < begun + timeout
        and not can()[0]
        and clock.now() + _JUMPED >= begun
    ):
        clock_of_the_run.sleep(_POLL_PERIOD)
    found = can()
    return found if with_reason else found[0]
