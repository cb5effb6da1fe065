"""Futures and tasks; a task is a function or coroutine that an executor runs."""

from __future__ import annotations

import inspect
import sys
import threading
import warnings
import weakref
from collections.abc import Callable, Coroutine, Generator
from itertools import count
from types import CodeType
from typing import TYPE_CHECKING, Any, Generic, TypeAlias, TypeGuard, TypeVar

from sim.ros.scheduling.asyncio_waits import AsyncioWaiter, driven_by_asyncio, wait_in_asyncio

if TYPE_CHECKING:
    from sim.ros.scheduling.executors import Executor

T = TypeVar("T")
task_numbers = count(1)
_allocate_lock = threading.Lock


class Future(Generic[T]):
    """A result that is available later. Thread-safe.

    Done-callbacks run as tasks of the future's executor. Without an executor they run at once, on the thread
    that sets the result.
    """

    def __init__(self, *, executor: Executor | None = None) -> None:
        self._early_check: Callable[[], None] | None = None
        self._done = False
        self._cancelled = False
        self._result: T | None = None
        self._exception: BaseException | None = None
        self._exception_fetched = False
        self._callbacks: list[_Listener[T]] = []
        self._lock = _allocate_lock()
        self._executor: weakref.ref[Executor] | None = None
        if executor is not None:
            self._set_executor(executor)

    def __del__(self) -> None:
        if self._exception is not None and not self._exception_fetched:
            sys.stderr.write(f"The following exception was never retrieved: {self._exception}\n")

    def __await__(self) -> Generator[Any, None, T | None]:
        while not self._settled():
            if driven_by_asyncio():
                yield from wait_in_asyncio(self._wake_when_done)
            else:
                yield self
        return self.result()

    def cancel(self) -> None:
        """Cancel the future, unless it is done."""
        with self._lock:
            if self._done or self._cancelled:
                return
            self._cancelled = True
        self._finish()

    def cancelled(self) -> bool:
        """Whether the future was cancelled."""
        return self._cancelled

    def done(self) -> bool:
        """Whether there is a result or an exception; a cancelled future has neither."""
        return self._done

    def _settled(self) -> bool:
        """Whether the future is done or cancelled."""
        return self._done or self._cancelled

    def result(self) -> T | None:
        """Return the result, or None if there is none yet; raise the exception if one was set."""
        if self._early_check is not None and not self._settled():
            self._early_check()
        if self._exception is not None:
            self._exception_fetched = True
            raise self._exception
        return self._result

    def exception(self) -> BaseException | None:
        """The exception that was set, or None."""
        self._exception_fetched = True
        return self._exception

    def set_result(self, result: T) -> None:
        """Set the result, and run the done-callbacks."""
        with self._lock:
            self._result = result
            self._done = True
            self._cancelled = False
        self._finish()

    def set_exception(self, exception: BaseException) -> None:
        """Set an exception instead of a result, and run the done-callbacks."""
        with self._lock:
            self._exception = exception
            self._exception_fetched = False
            self._done = True
            self._cancelled = False
        self._finish()

    def add_done_callback(self, callback: Callable[[Future[T]], object]) -> None:
        """Run ``callback(future)`` when the future is done; at once if it is done already."""
        self._wake_when_done(callback)

    def remove_done_callback(self, callback: Callable[[Future[T]], object]) -> bool:
        """Remove every registration of ``callback``; return whether there was one."""
        with self._lock:
            kept = [each for each in self._callbacks if each != callback]
            found = len(kept) < len(self._callbacks)
            self._callbacks = kept
        return found

    def _belong_to(self, executor: Executor) -> None:
        own = self._live_executor()
        if own is None:
            self._set_executor(executor)
        elif own is not executor:
            raise RuntimeError("A task can only await futures associated with the same executor")

    def _set_executor(self, executor: Executor) -> None:
        self._executor = weakref.ref(executor)

    def _live_executor(self) -> Executor | None:
        return None if self._executor is None else self._executor()

    def _wake_when_done(self, waiting: _Listener[T]) -> None:
        with self._lock:
            if not self._settled():
                self._callbacks.append(waiting)
                return
        self._run_callbacks([waiting])

    def _finish(self) -> None:
        if not self._callbacks:
            return  # there are no callbacks, and none can be added from now on
        with self._lock:
            callbacks, self._callbacks = self._callbacks, []
        self._run_callbacks(callbacks)

    def _run_callbacks(self, callbacks: list[_Listener[T]]) -> None:
        executor = self._live_executor()
        for callback in callbacks:
            if isinstance(callback, Task | AsyncioWaiter):
                callback._resume_soon()
            elif executor is not None and not getattr(executor, "_is_shutdown", False):
                executor.create_task(callback, self)
            else:
                self._run_here(callback)

    def _run_here(self, callback: Callable[[Future[T]], object]) -> None:
        try:
            callback(self)
        except Exception as error:  # noqa: BLE001 -- an error of a callback must not reach set_result()
            warnings.warn(f"Unhandled exception in done callback: {error}", RuntimeWarning, stacklevel=3)


class Task(Future[T]):
    """A function or coroutine that its executor runs; a call of the task runs it up to its next await."""

    def __init__(
        self,
        handler: Callable[..., Any] | Coroutine[Any, Any, Any],
        args: tuple[Any, ...] | None = None,
        kwargs: dict[str, Any] | None = None,
        executor: Executor | None = None,
    ) -> None:
        super().__init__(executor=executor)
        self.number = next(task_numbers)
        """The number of the task in the order of creation."""
        arguments, named = args or (), kwargs or {}
        if makes_coroutines(handler):
            handler = handler(*arguments, **named)
            arguments, named = (), {}
        self._handler: Any = handler
        self._args = arguments
        self._kwargs = named
        self._executing = False
        self._was_suspended = False
        self._awaited: object | None = None
        self._step_lock = _allocate_lock()

    def __call__(self) -> None:
        """Run the function, or the coroutine up to its next await, unless it is done or running elsewhere."""
        self._arm(self._advance())

    def _advance(self) -> object | None:
        """Run up to the next await; return what the coroutine awaits, or None."""
        if self._settled() or not self._step_lock.acquire(blocking=False):
            return None
        try:
            self._executing = True
            return self._step()
        finally:
            self._executing = False
            self._step_lock.release()

    def _arm(self, awaited: object | None) -> None:
        """Resume the task once ``awaited`` is done.

        Some releases instead resume it in the next cycle, and then at each wake-up of the executor; an
        EventsExecutor resumes it after each callback.

        Raises:
            RuntimeError: the future belongs to another executor.
            TypeError: an executor cannot wait for an object of that type.
        """
        was_suspended, self._was_suspended = self._was_suspended, True
        self._awaited = awaited
        executor = self._live_executor()
        if awaited is None or executor is None:
            return
        profile = executor._profile
        if not profile.resumes_at_once:
            asks_now = executor._runner.asks_in_next_cycle and not was_suspended
            (executor._resume if asks_now else executor._resume_at_wake_up)(self)
        elif isinstance(awaited, Future):
            awaited._belong_to(executor)
            awaited._wake_when_done(self._go_on if profile.loses_errors_after_await else self)
        elif awaited is _NOTHING_NAMED:
            executor._resume(self)
        else:
            raise TypeError(f"Expected coroutine to yield a Future or None, got: {type(awaited)}")

    def _go_on(self, _: Future[Any]) -> None:
        """Continue at once, as a done-callback of the awaited future."""
        executor = self._live_executor()
        if executor is not None:
            executor._runner.go_on(self)

    @property
    def _waits_still(self) -> bool:
        """Whether the awaited future is not done, so that the task cannot continue."""
        return isinstance(self._awaited, Future) and not self._awaited._settled()

    def executing(self) -> bool:
        """Whether the task is running."""
        return self._executing

    def cancel(self) -> None:
        """Cancel the task; a coroutine is closed, unless it is running."""
        super().cancel()
        if inspect.iscoroutine(self._handler) and not self._executing:
            self._handler.close()

    def _step(self) -> object | None:
        try:
            if not inspect.iscoroutine(self._handler):
                self.set_result(self._handler(*self._args, **self._kwargs))
                return None
            awaited = self._handler.send(None)
        except StopIteration as end:
            self.set_result(end.value)
        except Exception as error:  # noqa: BLE001 -- result() raises it
            self.set_exception(error)
        else:
            return _NOTHING_NAMED if awaited is None else awaited
        return None

    def _resume_soon(self) -> None:
        executor = self._live_executor()
        if executor is not None:
            executor._resume(self)


_Listener: TypeAlias = Callable[[Future[T]], object] | Task[Any] | AsyncioWaiter
"""What is notified when a future is done: a callback, or an awaiting task."""


def makes_coroutines(handler: object) -> TypeGuard[Callable[..., Coroutine[Any, Any, Any]]]:
    """As ``inspect.iscoroutinefunction``, but much faster for functions and methods."""
    code = getattr(handler, "__code__", None)
    if isinstance(code, CodeType):
        return code.co_flags & inspect.CO_COROUTINE != 0
    return inspect.iscoroutinefunction(handler)


_NOTHING_NAMED = object()
"""The result of an await that names no future (a bare ``yield``)."""
