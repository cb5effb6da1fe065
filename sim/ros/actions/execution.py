"""The execute callbacks of action servers on the trace: an executor runs them as tasks."""

import inspect
from collections.abc import Callable, Coroutine, Generator
from types import coroutine
from typing import Any

from sim.ros.scheduling.executors import Executor
from sim.ros.scheduling.program_task import TaskEntity
from sim.ros.scheduling.task import makes_coroutines


class GoalRun:
    """One run of an execute callback on the trace, from its start to its end, with all its suspensions."""

    def __init__(self, execution: TaskEntity, executor: Executor) -> None:
        self._execution = execution
        self._runner = executor._runner
        self._probe = execution.node.context.probe
        self._outer = 0

    @coroutine
    def run(self, callback: Callable[..., Any], goal: Any) -> Generator[Any, Any, Any]:
        """Run an execute callback, also a coroutine, in the task that awaits this; return its result."""
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
