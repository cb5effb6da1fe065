"""What an executor that a program wrote is given to call: one callback, from group entered to group left."""

from __future__ import annotations

import inspect
from collections.abc import Coroutine, Generator
from types import coroutine
from typing import TYPE_CHECKING, Any

from sim.ros.scheduling.task import Task

if TYPE_CHECKING:
    from sim.ros.scheduling.entity import Entity
    from sim.ros.scheduling.executor import Executor


class Handler(Task[None]):
    """Runs an entity's callback when it is called, on the calling thread.

    Done once the callback has ended, or was refused by its group. What the callback raises is the handler's
    exception. A coroutine is run up to its next await; when it can go on, the handler is yielded again.
    """

    def __init__(self, entity: Entity, executor: Executor) -> None:
        self.entity = entity
        self._outer = 0
        self._serving = executor  # which has to be there as long as its callback runs
        self._runner = executor._runner
        self._begun = False
        super().__init__(_nothing, executor=executor)

    def _step(self) -> object | None:
        # Begun no earlier, so that Python does not complain about a handler that is never called.
        if not self._begun:
            self._begun = True
            self._handler = self._serve()
        return super()._step()

    async def _serve(self) -> None:
        runner, entity = self._runner, self.entity
        with runner.lock:
            taken = runner.enter(entity, runner.clock.now())
            if taken is None:
                return
            self._outer = self._serving._probe.callback_started(entity, taken.message, taken.age, taken.left)
        try:
            outcome = entity.invoke(taken)
            if inspect.iscoroutine(outcome):
                await self._steps_of(outcome)
        except BaseException as error:
            runner.fail(entity, error, self._outer)
            raise
        runner.end(entity, self._outer)

    @coroutine
    def _steps_of(self, callback: Coroutine[Any, Any, Any]) -> Generator[Any, None, None]:
        while True:
            try:
                awaited = callback.send(None)
            except StopIteration:
                return
            self._runner.suspend(self.entity, self._outer)
            try:
                yield awaited
            finally:
                self._outer = self._runner.resume(self.entity)


def _nothing() -> None:
    """Stand for what is done, until it is begun."""
