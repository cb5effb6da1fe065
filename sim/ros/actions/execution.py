"""Goals at work, on the trace.

An executor runs a goal's execute callback as a task, which belongs to no callback group. So that it is seen
all the same, each action server has one entity more, in a reentrant group of its own: that group lets
everything in, as being in none does.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Coroutine, Generator
from types import coroutine
from typing import TYPE_CHECKING, Any

from sim.ros.scheduling.callback_groups import ReentrantCallbackGroup
from sim.ros.scheduling.entity import Entity, Taken
from sim.trace.events import EntityKind

if TYPE_CHECKING:
    from sim.ros.node.node import Node
    from sim.ros.scheduling.executors import Executor


class GoalExecution(Entity):
    """Stands on the trace for the execute callback of an action server.

    It is nothing that a node has or an executor yields.
    """

    kind = EntityKind.WAITABLE
    rank = -1

    def __init__(self, node: Node, action_name: str, callback: Callable[..., Any] | None) -> None:
        self._callback = callback
        super().__init__(node, action_name, ReentrantCallbackGroup())
        node.context.probe.entity_made(self)

    def shown_callback(self) -> Callable[..., Any] | None:
        """The execute callback."""
        return self._callback

    def take(self, now: int) -> Taken | None:
        """Take nothing: nothing ever arrives here."""
        return None

    def invoke(self, taken: Taken) -> None:
        """Do nothing, for nothing can have been taken."""

    def destroy(self) -> None:
        """Leave the trace. With the host's lock held."""
        self.destroyed = True
        self.node.context.probe.entity_gone(self)

    @coroutine
    def run(self, executor: Executor, callback: Callable[..., Any], goal: Any) -> Generator[Any, Any, Any]:
        """Run an execute callback, a coroutine too, inside the task that awaits this; returns its result."""
        stay = _Stay(self, executor)
        stay.begin()
        try:
            outcome = callback(goal)
            if inspect.iscoroutine(outcome):
                outcome = yield from stay.drive(outcome)
        except GeneratorExit:
            raise  # the task was given up while it was suspended: there is nothing more to tell
        except BaseException as error:
            stay.fail(error)
            raise
        stay.end()
        return outcome


class _Stay:
    """One run of an execute callback on the lanes: from its beginning to its end, with all its pauses."""

    def __init__(self, execution: GoalExecution, executor: Executor) -> None:
        self._execution = execution
        self._executor = executor
        self._probe = execution.node.context.probe
        self._outer = 0

    def begin(self) -> None:
        self._outer = self._probe.callback_started(self._execution, 0, 0, 0)
        self._enter()

    def drive(self, steps: Coroutine[Any, Any, Any]) -> Generator[Any, Any, Any]:
        """Run a coroutine, telling when it is suspended and resumed; returns its result."""
        while True:
            try:
                awaited = steps.send(None)
            except StopIteration as end:
                return end.value
            self._suspend()
            try:
                yield awaited
            except GeneratorExit:
                steps.close()
                raise
            self._resume()

    def fail(self, error: BaseException) -> None:
        if not isinstance(error, KeyboardInterrupt):
            self._probe.callback_failed(self._execution, error)
        self.end()

    def end(self) -> None:
        self._leave()
        self._probe.callback_ended(self._execution, self._outer)

    def _suspend(self) -> None:
        self._leave()
        self._probe.callback_suspended(self._execution, self._outer)

    def _resume(self) -> None:
        self._outer = self._probe.callback_resumed(self._execution)
        self._enter()

    def _enter(self) -> None:
        self._executor._runner.show(self._execution)

    def _leave(self) -> None:
        self._executor._runner.hide(self._execution)
