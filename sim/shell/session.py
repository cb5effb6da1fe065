"""What a verb uses while it is carried out: a hidden node, its time, and a place for its output."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from sim.ros.node.node import Node
from sim.ros.scheduling.executors import Executor, ExternalShutdownException, SingleThreadedExecutor
from sim.ros.scheduling.task import Future
from sim.shell.ground import Ground, TakeOutput
from sim.shell.starter import LineStarter

_SERVICE_POLL = 0.25
"""Seconds between two looks for a service, as in rclpy."""


class CommandFailed(Exception):  # noqa: N818 -- a line's result, as a shell would word it
    """The line failed with exit status 1; the text goes to stderr."""


class LineExit(Exception):  # noqa: N818
    """The line ended with a status, without a message."""

    def __init__(self, status: int) -> None:
        super().__init__(status)
        self.status = status


class CommandInterrupted(Exception):  # noqa: N818
    """Ctrl-C, or the end of the context."""


class ShellSession:
    """One line's presence on the network. Other threads than the line's may only call ``interrupt``."""

    def __init__(self, ground: Ground, starter: LineStarter, take: TakeOutput) -> None:
        self.ground = ground
        self.starter = starter
        self.process = ground.enter(take)
        self._take = take
        self._interrupted = False
        self._listeners: list[Callable[[], None]] = []
        self._made_node: Node | None = None
        self._made_executor: Executor | None = None

    @property
    def node(self) -> Node:
        """The hidden node, which is created at its first use."""
        if self._made_node is None:
            self.make_node(self.process.free_name())
        assert self._made_node is not None
        return self._made_node

    def make_node(self, name: str) -> None:
        """Make the line's node under a name that the line chooses."""
        self._made_node = self.process.make_node(name)
        self._executor.add_node(self._made_node)

    @property
    def _executor(self) -> Executor:
        # Made on the line's own thread, so that it belongs to the line's process.
        if self._made_executor is None:
            self._made_executor = SingleThreadedExecutor(context=self.process.context)
        return self._made_executor

    # Output

    def say(self, text: str = "") -> None:
        """Write text, and a line end, to stdout."""
        for line in text.split("\n"):
            self._take(line, False)

    def say_each(self, lines: Iterable[str], count: bool = False) -> None:
        """Write texts line by line; with ``count`` only their number."""
        every = list(lines)
        if count:
            self.say(str(len(every)))
        elif every:
            self.say("\n".join(every))

    def complain(self, text: str) -> None:
        """Write text, and a line end, to stderr."""
        for line in text.split("\n"):
            self._take(line, True)

    # Waiting

    def spin(self, until: Future[Any] | None = None, seconds: float | None = None) -> bool:
        """Spin the node until the future is done, for at most some seconds; return whether it is done.

        Raises:
            CommandInterrupted: the line was interrupted meanwhile.
        """
        self.check()
        future = Future() if until is None else until
        try:
            self._executor.spin_until_future_complete(future, seconds)
        except ExternalShutdownException:
            raise CommandInterrupted from None
        self.check()
        return future.done()

    def sleep(self, seconds: float) -> None:
        """Let time pass; raises as ``spin``."""
        if seconds > 0:
            self.spin(seconds=seconds)

    def wait_until(self, condition: Callable[[], bool], poll: float = _SERVICE_POLL) -> None:
        """Check ``condition`` every ``poll`` seconds until it holds; raises as ``spin``."""
        while not condition():
            self.sleep(poll)

    def check(self) -> None:
        """Raise CommandInterrupted if the line was interrupted."""
        if self._is_interrupted:
            raise CommandInterrupted

    @property
    def _is_interrupted(self) -> bool:
        return self._interrupted or not self.process.context.ok()

    # Interrupting

    def on_interrupt(self, listener: Callable[[], None]) -> None:
        """Call ``listener`` at every Ctrl-C, at once if there was one already; it must not wait."""
        self._listeners.append(listener)
        if self._is_interrupted:
            listener()

    def interrupt(self) -> None:
        """End every wait of the line."""
        self._interrupted = True
        for listener in tuple(self._listeners):
            listener()
        if self._made_executor is not None:
            self._made_executor.shutdown(timeout_sec=0)

    def close(self) -> None:
        """Leave the network."""
        if self._made_node is not None:
            self._made_node.destroy_node()
        self.process.leave()
