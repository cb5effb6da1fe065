"""Handlers: tasks that a program's own executor calls to run one callback within its group."""

from __future__ import annotations

import inspect
import warnings
from collections.abc import Coroutine, Generator
from types import coroutine
from typing import TYPE_CHECKING, Any

from sim.interpreter.function_marks import sends_responses
from sim.ros.scheduling.entity import Entity
from sim.ros.scheduling.task import Task, makes_coroutines
from sim.trace.events import EntityKind

if TYPE_CHECKING:
    from sim.ros.scheduling.executor import Executor


class Handler(Task[None]):
    """Runs an entity's callback on the calling thread when it is called.

    It is done when the callback has ended, or when the group refused it. An exception of the callback is the
    handler's exception. A coroutine runs up to its next await; when it can continue, the handler is yielded
    again.
    """

    def __init__(self, entity: Entity, executor: Executor) -> None:
        self.entity = entity
        self._outer = 0
        self._serving = executor  # a reference, so that the executor lives as long as the callback runs
        self._runner = executor._runner
        self._begun = False
        super().__init__(_nothing, executor=executor)

    def _step(self) -> object | None:
        # Not created before, because Python warns about a coroutine that is never awaited.
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
                if awaits(entity):
                    await self._steps_of(outcome)
                else:
                    discard(entity, outcome)
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
            self._runner.suspend(self.entity, self._outer, callback)
            try:
                yield awaited
            finally:
                self._outer = self._runner.resume(self.entity)


_CALLED = (EntityKind.TIMER, EntityKind.SUBSCRIPTION, EntityKind.SERVICE, EntityKind.GUARD)


def awaits(entity: Entity) -> bool:
    """Whether an executor awaits the coroutine that a callback returned: a coroutine function's, as in rclpy.

    So it does not await what a lambda returns. (7.1.6 and 9.1.2 were measured.)
    """
    return entity.kind not in _CALLED or makes_coroutines(getattr(entity, "callback", None))


@sends_responses
def discard(entity: Entity, coroutine: Coroutine[Any, Any, Any]) -> None:
    """Let Python warn of a coroutine that a callback returned and nobody awaits.

    Raises:
        TypeError: a service has to answer with it.
    """
    if entity.kind is EntityKind.SERVICE:
        coroutine.close()
        raise TypeError("a service's callback returned a coroutine, which is no response")
    python: Any = warnings
    python._warn_unawaited_coroutine(coroutine)
    coroutine.close()


def _nothing() -> None:
    """The placeholder until the callback is started."""
