"""The execute callbacks of action servers on the trace.

An executor runs a goal's execute callback as a task, which belongs to no callback group. So that the trace
shows the callback, each action server has one more entity, in a reentrant group of its own: that group admits
everything, as if there were none.
"""

import inspect
from collections.abc import Callable, Coroutine, Generator
from types import coroutine
from typing import Any

from sim.ros.node.node import Node
from sim.ros.scheduling.callback_groups import ReentrantCallbackGroup
from sim.ros.scheduling.entity import Entity, TakenData
from sim.ros.scheduling.executors import Executor
from sim.ros.scheduling.task import makes_coroutines
from sim.trace.events import EntityKind


class GoalExecution(Entity):
    """The entity that stands for an action server's execute callback on the trace.

    No node has it, and no executor yields it.
    """

    kind = EntityKind.WAITABLE
    rank = -1

    def __init__(self, node: Node, action_name: str, callback: Callable[..., Any] | None) -> None:
        self.callback = callback
        super().__init__(node, action_name, ReentrantCallbackGroup())
        node.context.probe.entity_made(self)

    def take(self, now: int) -> TakenData | None:
        """None: nothing arrives here."""
        return None

    def invoke(self, taken: TakenData) -> None:
        """Do nothing: nothing can be taken."""

    def destroy(self) -> None:
        """Remove it from the trace. With the host's lock held."""
        self.destroyed = True
        self.node.context.probe.entity_gone(self)

    @coroutine
    def run(self, executor: Executor, callback: Callable[..., Any], goal: Any) -> Generator[Any, Any, Any]:
        """Run an execute callback, also a coroutine, in the task that awaits this; return its result."""
        return (yield from _GoalRun(self, executor).run(callback, goal))


class _GoalRun:
    """One run of an execute callback on the trace, from its start to its end, with all its suspensions."""

    def __init__(self, execution: GoalExecution, executor: Executor) -> None:
        self._execution = execution
        self._runner = executor._runner
        self._probe = execution.node.context.probe
        self._outer = 0

    def run(self, callback: Callable[..., Any], goal: Any) -> Generator[Any, Any, Any]:
        self._outer = self._probe.callback_started(self._execution, 0, 0, 0)
        self._runner.show(self._execution)
        try:
            outcome = callback(goal)
            if inspect.iscoroutine(outcome) and makes_coroutines(callback):
                outcome = yield from self._drive(outcome)
        except GeneratorExit:
            raise  # the task was cancelled while it was suspended: the trace has its suspension already
        except BaseException as error:
            if not isinstance(error, KeyboardInterrupt):
                self._probe.callback_failed(self._execution, error)
            self._end()
            raise
        self._end()
        return outcome

    def _drive(self, steps: Coroutine[Any, Any, Any]) -> Generator[Any, Any, Any]:
        """Run a coroutine, and record when it is suspended and resumed; return its result."""
        while True:
            try:
                awaited = steps.send(None)
            except StopIteration as end:
                return end.value
            self._runner.hide(self._execution)
            self._probe.callback_suspended(self._execution, self._outer, steps)
            try:
                yield awaited
            except GeneratorExit:
                steps.close()
                raise
            self._outer = self._probe.callback_resumed(self._execution)
            self._runner.show(self._execution)

    def _end(self) -> None:
        self._runner.hide(self._execution)
        self._probe.callback_ended(self._execution, self._outer)
