"""What differs between releases of rclpy, each as a named behaviour with its source.

A profile is a distribution of ROS 2 at a patch of rclpy. ``#1469`` and the like are pull requests and issues
of ros2/rclpy; the notes of its releases tell which patch has them. Jazzy 7.1.5 and Kilted 9.1.2 were
run, too: ``tests/ros/profiles`` has a program for each behaviour in which they differ. (Jazzy's wheels call
themselves 7.1.6; their rclpy says 7.1.5, and has nothing of what the notes of 7.1.6 list.) Humble and Lyrical
follow source and release notes alone.

Known, but not modelled: before #1469 a callback that waits for a worker is handed over again whenever the
executor wakes. A program sees it only by chance: by exceptions that come out twice, or earlier, and by a
second worker for a single timer. ``with`` blocks of ``rclpy.init()``, of nodes and of what they make came
with Kilted (#1291 to #1298), and raise TypeError before; here every release has them. None has what Kilted
added besides: content filters of subscriptions, introspection of actions, ``rosout_qos_profile``.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

DISTROS = {"humble": "3.3.22", "jazzy": "7.1.12", "kilted": "9.1.2", "lyrical": ""}
"""The distributions, and the patch that is meant where none is named; those of Lyrical are not known."""

RUN = ("jazzy", "kilted")
"""Those of which real rclpy was run beside the model."""


class UnknownProfileError(ValueError):
    """There is no such distribution, or no such patch of it; the text is a sentence on that."""


@dataclass(frozen=True)
class Profile:
    """A distribution, and a patch of its rclpy. Its properties are the behaviours."""

    distro: str = "jazzy"
    patch: str = DISTROS["jazzy"]

    @classmethod
    def named(cls, name: str) -> Profile:
        """The profile of a name such as ``kilted`` or ``jazzy@7.1.5``.

        Raises:
            UnknownProfileError: there is none.
        """
        distro, _, patch = name.partition("@")
        usual = DISTROS.get(distro)
        if usual is None:
            *others, last = DISTROS
            give = f"{', '.join(others)} or {last}"
            raise UnknownProfileError(f"{distro!r} is no distribution; give {give}")
        if "@" not in name:
            return cls(distro, usual)
        line = usual.rpartition(".")[0]
        if not line:
            raise UnknownProfileError(f"which patches {distro} has is not known; give {distro} alone")
        if not re.fullmatch(rf"{re.escape(line)}\.\d{{1,4}}", patch):
            raise UnknownProfileError(f"{distro} has no rclpy {patch!r}; give one like {distro}@{usual}")
        return cls(distro, patch)

    def __str__(self) -> str:
        return f"{self.distro}@{self.patch}" if self.patch else self.distro

    def _since(self, **first: str) -> bool:
        """Whether a change is in; ``first`` has the first patch of a distribution with it, "" for all."""
        if self.distro not in first:
            return False
        return not self.patch or _numbers(self.patch) >= _numbers(first[self.distro])

    # Tasks and futures

    @property
    def newest_task_first(self) -> bool:
        """Tasks that are due together run in the reverse order of their making.

        Source: #1304 has them run in order, from Kilted on; #1560 says that Jazzy keeps the order it had.
        """
        return not self._since(kilted="", lyrical="")

    @property
    def resumes_at_once(self) -> bool:
        """What awaits a future goes on when that is done, in the executor whose the future is then.

        Else it is asked again whenever its own executor has been woken. Source: #1469.
        """
        return self._since(humble="3.3.21", jazzy="7.1.9", kilted="9.1.4", lyrical="")

    @property
    def loses_errors_after_await(self) -> bool:
        """What a coroutine raises after an await does not come out of a single-threaded ``spin``.

        Source: #1642, which came with #1469 and is mended by #1643.
        """
        return self.resumes_at_once and not self._since(humble="3.3.22", lyrical="")

    # Spinning

    @property
    def refuses_second_spin(self) -> bool:
        """Who spins an executor that spins, in a callback or another thread, gets an error. Source: #1510."""
        return self._since(jazzy="7.1.9", kilted="9.1.5", lyrical="")

    @property
    def wakes_once_for_a_future(self) -> bool:
        """``spin_until_future_complete`` leaves one task that wakes it, not one for each callback it ran.

        Source: #1374.
        """
        return self._since(jazzy="7.1.8", kilted="", lyrical="")

    @property
    def keeps_attached_nodes(self) -> bool:
        """``rclpy.spin_once`` and its like let go only of a node that they added. Source: #1316, #1446."""
        return self._since(humble="3.3.17", jazzy="7.1.5", kilted="", lyrical="")

    @property
    def warns_of_one_thread(self) -> bool:
        """A ``MultiThreadedExecutor`` with one thread warns. Source: run on Humble 3.3, which does not."""
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
        """Shutting a context down destroys its nodes; a signal does not. Source: #1298."""
        return self._since(kilted="", lyrical="")

    @property
    def tells_missing_init(self) -> bool:
        """An executor made before ``rclpy.init`` raises a RuntimeError that says so, else a TypeError.

        Source: run on both wheels.
        """
        return self._since(kilted="", lyrical="")

    @property
    def refuses_transitions(self) -> bool:
        """A transition that a life cycle's state does not have is answered with an error.

        Else RCLError comes out of who asks; where a service asks, out of ``spin``. Source: #1319.
        """
        return self._since(kilted="", lyrical="")

    # Clients and timers

    @property
    def call_takes_timeout(self) -> bool:
        """``Client.call`` takes ``timeout_sec``. Source: #1188."""
        return self._since(jazzy="", kilted="", lyrical="")

    @property
    def call_raises_timeout(self) -> bool:
        """``Client.call`` raises TimeoutError when time runs out; else it returns None. Source: #1271."""
        return self._since(kilted="", lyrical="")

    @property
    def gives_timer_info(self) -> bool:
        """A timer's callback may ask for a ``TimerInfo``.

        A timer without a callback fails with UnboundLocalError then, for its parameters are looked for.
        Source: #1292.
        """
        return self._since(kilted="", lyrical="")

    @property
    def skips_cancelled_timers(self) -> bool:
        """A timer that is cancelled while its call waits for a worker is not called.

        Else ``spin`` raises, the timer is never called again, and its group stays held.
        Source: #1488, #1487 for Jazzy and #1486 for Humble, whose patch is placed by its date; run on both.
        """
        return self._since(humble="3.3.18", jazzy="7.1.6", kilted="", lyrical="")


def _numbers(patch: str) -> tuple[int, ...]:
    return tuple(map(int, patch.split("."))) if patch else ()
