"""What differs between releases of rclpy, each as a named behaviour with its source.

A profile is a distribution of ROS 2 at a patch of rclpy. ``#1469`` and the like are pull requests and issues
of ros2/rclpy; its release notes name the patch that has them. Jazzy 7.1.5 and Kilted 9.1.2 were also run:
``tests/ros/profiles`` has a program for each behaviour in which they differ. (Jazzy's wheels call themselves
7.1.6; their rclpy says 7.1.5, and has no change that the notes of 7.1.6 list.) Humble and Lyrical follow
source and release notes alone.

Known, but not modelled: before #1469 a callback that waits for a worker is handed over again whenever the
executor wakes; while a message waits for one, that is about 1,100 times a second. ``hands_over_again`` has
the workers that this starts. A program notices the rest only by chance: an exception comes out twice or
earlier, or other threads are late. An error in a task or coroutine callback of an ``EventsExecutor`` that has
one node ends the process with a segmentation fault (#1641, run on both wheels; #1718 mends it, in no patch
that is known here); the model logs that, and raises. No release here has Kilted's content filters of
subscriptions, introspection of actions and ``rosout_qos_profile``; a program that uses one is told so.
"""

from __future__ import annotations

from dataclasses import dataclass

from sim.releases.distros import DISTROS, distro_and_patch


@dataclass(frozen=True)
class Profile:
    """A distribution at a patch of its rclpy; each property is a behaviour."""

    distro: str = "jazzy"
    patch: str = DISTROS["jazzy"]

    @classmethod
    def named(cls, name: str) -> Profile:
        """Return the profile of a name such as ``kilted`` or ``jazzy@7.1.5``.

        Raises:
            UnknownProfileError: there is no such distribution or patch.
        """
        return cls(*distro_and_patch(name))

    def __str__(self) -> str:
        return f"{self.distro}@{self.patch}" if self.patch else self.distro

    def _since(self, **first: str) -> bool:
        """Return whether a change is in; ``first`` has its first patch in each distribution, "" for all."""
        if self.distro not in first:
            return False
        return not self.patch or _numbers(self.patch) >= _numbers(first[self.distro])

    # Tasks and futures

    @property
    def newest_task_first(self) -> bool:
        """Tasks that are due together run in the reverse of the order in which they were created.

        Source: #1304 has them run in order, from Kilted on; #1560 says that Jazzy keeps the order it had.
        """
        return not self._since(kilted="", lyrical="")

    @property
    def resumes_at_once(self) -> bool:
        """A coroutine that awaits a future resumes when it is done, in the executor that has the future then.

        Else its own executor polls it after each wake-up. Source: #1469.
        """
        return self._since(humble="3.3.21", jazzy="7.1.9", kilted="9.1.4", lyrical="")

    @property
    def hands_over_again(self) -> bool:
        """Each cycle of a pool hands over again what no worker has begun, and starts workers for it.

        Source: run on both wheels; #1469 hands each over once.
        """
        return not self.resumes_at_once

    @property
    def loses_errors_after_await(self) -> bool:
        """An error that a coroutine raises after an await does not come out of a single-threaded ``spin``.

        Source: #1642, which came with #1469 and is fixed by #1643.
        """
        return self.resumes_at_once and not self._since(humble="3.3.22", lyrical="")

    # Spinning

    @property
    def refuses_second_spin(self) -> bool:
        """A second spin of an executor, in a callback or another thread, raises an error. Source: #1510."""
        return self._since(jazzy="7.1.9", kilted="9.1.5", lyrical="")

    @property
    def wakes_once_for_a_future(self) -> bool:
        """``spin_until_future_complete`` leaves one task that wakes it, not one for each callback run.

        Source: #1374.
        """
        return self._since(jazzy="7.1.8", kilted="", lyrical="")

    @property
    def keeps_attached_nodes(self) -> bool:
        """``rclpy.spin_once`` and its like remove only a node that they added. Source: #1316, #1446."""
        return self._since(humble="3.3.17", jazzy="7.1.5", kilted="", lyrical="")

    @property
    def warns_of_one_thread(self) -> bool:
        """A ``MultiThreadedExecutor`` with one thread warns. Source: Humble 3.3, as run, does not."""
        return self._since(jazzy="", kilted="", lyrical="")

    @property
    def ends_workers(self) -> bool:
        """``MultiThreadedExecutor.shutdown`` waits for its workers, unless told not to. Source: #1309."""
        return self._since(jazzy="7.1.12", kilted="", lyrical="")

    @property
    def events_executor_runs_coroutines(self) -> bool:
        """Coroutine callbacks of subscriptions and services run on an ``EventsExecutor``. Source: #1478."""
        return self._since(jazzy="7.1.11", kilted="", lyrical="")

    # Contexts and nodes

    @property
    def ends_nodes_with_context(self) -> bool:
        """``shutdown`` of a context destroys its nodes; a signal does not. Source: #1298."""
        return self._since(kilted="", lyrical="")

    @property
    def has_with_blocks(self) -> bool:
        """``rclpy.init()``, nodes and their entities end with a ``with`` block; else it raises TypeError.

        Source: #1291 to #1298.
        """
        return self._since(kilted="", lyrical="")

    def require_with_blocks(self, entered: object) -> None:
        """Raise the TypeError of ``with`` for what is no context manager in a release without them."""
        if not self.has_with_blocks:
            name = type(entered).__name__
            raise TypeError(f"{name!r} object does not support the context manager protocol")

    @property
    def tells_missing_init(self) -> bool:
        """An executor made before ``rclpy.init`` raises a RuntimeError that says so, else a TypeError.

        Source: run on both wheels.
        """
        return self._since(kilted="", lyrical="")

    @property
    def refuses_transitions(self) -> bool:
        """A transition that the current life-cycle state does not allow returns an error.

        Else the call raises RCLError; if a service asked for it, ``spin`` raises. Source: #1319.
        """
        return self._since(kilted="", lyrical="")

    # Clients and timers

    @property
    def call_takes_timeout(self) -> bool:
        """``Client.call`` takes ``timeout_sec``. Source: #1188."""
        return self._since(jazzy="", kilted="", lyrical="")

    @property
    def call_raises_timeout(self) -> bool:
        """``Client.call`` raises TimeoutError at its timeout; else it returns None. Source: #1271."""
        return self._since(kilted="", lyrical="")

    @property
    def gives_timer_info(self) -> bool:
        """A timer's callback may ask for a ``TimerInfo``.

        A timer without a callback then fails with UnboundLocalError, as rclpy reads its parameters.
        Source: #1292.
        """
        return self._since(kilted="", lyrical="")

    @property
    def skips_cancelled_timers(self) -> bool:
        """A timer that is cancelled while its call waits for a worker is not called.

        Else ``spin`` raises, the timer is never called again, and its group stays held.
        Source: #1488, #1487 for Jazzy and #1486 for Humble, whose patch follows from its date; run on both.
        """
        return self._since(humble="3.3.18", jazzy="7.1.6", kilted="", lyrical="")


def _numbers(patch: str) -> tuple[int, ...]:
    return tuple(map(int, patch.split("."))) if patch else ()
