"""Hooks that follow executors: their workers, what these run, and whether anybody spins them."""

from __future__ import annotations

import sys
import weakref
from contextlib import suppress
from functools import wraps
from threading import get_ident
from typing import TYPE_CHECKING, Any

from .callbacks import is_own, told_of
from .recorder import now
from .states import STATE, state_of
from .unseen import UNSEEN, leave_out_probe

if TYPE_CHECKING:
    from collections.abc import Callable

    from .recorder import Recorder
    from .tuning import Tuning
    from .turns import Turns

_IDLE = 200_000_000
"""Nanoseconds without activity after which an executor counts as not spun."""


class Spinner:
    """The state of one executor: its id, how many callbacks it can run at once, and what it runs."""

    def __init__(self, number: int, threads: int, *, asks_groups: bool) -> None:
        self.number = number
        self.threads = threads
        self.asks_groups = asks_groups
        self.waits = False
        """Whether a thread waits in it for ready callbacks."""
        self.busy: dict[int, int] = {}
        """The entities whose callbacks run, by thread; both by their ids on the trace."""
        self.spins = 0
        """How many spinning calls have not returned."""
        self.seconds: set[int] = set()
        """Python's identifiers of threads that spin it while another one does."""
        self.spun_at = -_IDLE
        """When it was last spun."""

    def is_spun(self) -> bool:
        """Whether it is being spun, or was until just now."""
        return self.spins > 0 or self.waits or bool(self.busy) or now() - self.spun_at < _IDLE


class Executors:
    """Hooks the creation and the waiting of executors."""

    def __init__(self, recorder: Recorder, tuning: Tuning, turns: Turns) -> None:
        self._recorder = recorder
        self._tuning = tuning
        self._turns = turns
        self._spinners: Any = weakref.WeakKeyDictionary()

    def spinner_of(self, executor: Any) -> Spinner | None:
        """The state of an executor; None if it is not known."""
        known: Spinner | None = None if executor is None else self._spinners.get(executor)
        return known

    def serving(self, node: Any) -> Spinner | None:
        """The state of the executor that has a node, which only the executor knows; None for none."""
        executor = node.executor
        return self.spinner_of(executor) if executor is not None and node in executor.get_nodes() else None

    def all(self) -> list[Spinner]:
        """The states of all executors. Thread-safe: the list is copied at once."""
        return list(self._spinners.data.values())

    def watch(self, rclpy: Any, rclpy_implementation: Any) -> None:
        """Record rclpy's executors, those in C++ included."""
        executors = rclpy.executors
        base, pool_class = executors.Executor, executors.MultiThreadedExecutor
        make, make_pool, wait = base.__init__, pool_class.__init__, base.wait_for_ready_callbacks
        add, local, turns = base.add_node, self._recorder.local, self._turns

        @wraps(make)
        def init(executor: Any, *args: Any, **kwargs: Any) -> None:
            make(executor, *args, **kwargs)
            if not isinstance(executor, pool_class):
                self._know(executor, 1)
                self._tuning.tell_of_single_thread()

        @wraps(make_pool)
        def init_pool(executor: Any, num_threads: int | None = None, **kwargs: Any) -> None:
            make_pool(executor, self._tuning.threads or num_threads, **kwargs)
            pool = executor._executor
            pool._initializer = self._work_for(self._know(executor, pool._max_workers))

        @wraps(wait)
        def wait_for_ready_callbacks(executor: Any, *args: Any, **kwargs: Any) -> Any:
            spinner, here = getattr(executor, STATE), local.here
            outer, here.spinner = here.spinner, spinner
            try:
                if spinner.spun_at > turns.late_at:
                    turns.let()
                spinner.waits = True
                return wait(executor, *args, **kwargs)
            except BaseException as error:
                leave_out_probe(error)
                raise
            finally:
                spinner.waits = False
                spinner.spun_at = now()
                if here.entity:  # otherwise its callbacks come now
                    here.spinner = outer

        @wraps(add)
        def add_node(executor: Any, node: Any) -> Any:
            former = node.executor
            if former is not executor and self._serves(former, node) and node not in executor.get_nodes():
                recorder = self._recorder
                recorder.put(
                    "spin_clash", now(), recorder.here.entity, state_of(node) or 0, *_call_into_rclpy()
                )
            with UNSEEN:
                return add(executor, node)

        base.__init__ = init
        base.add_node = add_node
        pool_class.__init__ = init_pool
        self._watch_exceptions(pool_class)
        self._give_threads(executors.SingleThreadedExecutor, pool_class)
        base.wait_for_ready_callbacks = wait_for_ready_callbacks
        self._watch_spinning(base, "spin", _itself)
        self._watch_spinning(base, "spin_until_future_complete", _itself)
        for each in (executors.SingleThreadedExecutor, pool_class):
            self._watch_spinning(each, "spin_once", _itself)
            self._watch_spinning(each, "spin_once_until_future_complete", _itself)

        def of_spin(node: Any, executor: Any = None) -> Any:  # noqa: ARG001 - it may come by its keyword
            return executor or rclpy.get_global_executor()

        self._watch_spinning(rclpy, "spin", of_spin)
        if hasattr(rclpy_implementation, "EventsExecutor"):
            for name in (
                "spin",
                "spin_once",
                "spin_until_future_complete",
                "spin_once_until_future_complete",
            ):
                self._watch_spinning(rclpy_implementation.EventsExecutor, name, _itself)

    def _watch_exceptions(self, pool_class: Any) -> None:
        """Record what comes out of a pool, which keeps the exceptions of callbacks."""
        spin_once, recorder = pool_class._spin_once_impl, self._recorder

        @wraps(spin_once)
        def raising(*args: Any, **kwargs: Any) -> None:
            try:
                spin_once(*args, **kwargs)
            except Exception as error:
                recorder.put("exception_surfaced", now(), recorder.thread(), *told_of(error))
                leave_out_probe(error)
                raise

        pool_class._spin_once_impl = raising

    def _give_threads(self, single: Any, pool_class: Any) -> None:
        """Make a MultiThreadedExecutor of each SingleThreadedExecutor if the run is to have more threads."""

        def new(made: Any, *args: Any, **kwargs: Any) -> Any:
            return pool_class(*args, **kwargs) if made is single else object.__new__(made)

        if (self._tuning.threads or 1) > 1:
            single.__new__ = staticmethod(new)

    def _watch_spinning(self, owner: Any, name: str, executor_of: Callable[..., Any]) -> None:
        """Note that an executor is spun while a spinning function runs; a C++ executor shows no more.

        One that another such function calls is left alone.
        """
        spin = getattr(owner, name)

        @wraps(spin)
        def spin_known(*args: Any, **kwargs: Any) -> Any:
            here = self._recorder.here
            if here.spins_in == here.entity:
                return spin(*args, **kwargs)
            executor = executor_of(*args, **kwargs)
            spinner = self._spinners.get(executor) or self._know(executor, 1)
            outer, here.spinner = here.spinner, spinner
            is_second = outer is not spinner and not here.entity and spinner.spins > 0
            if is_second or (here.entity and outer is spinner):
                function, *place = _call_into_rclpy()
                self._recorder.put("spin_clash", now(), here.entity, 0, function or name, *place, False)
            if is_second:
                spinner.seconds.add(get_ident())
            spinner.spins += 1
            within, here.spins_in = here.spins_in, here.entity
            try:
                with UNSEEN:
                    return spin(*args, **kwargs)
            finally:
                spinner.spins -= 1
                here.spins_in = within
                if is_second:
                    spinner.seconds.discard(get_ident())
                spinner.spun_at = now()
                here.spinner = outer

        setattr(owner, name, spin_known)

    def _serves(self, executor: Any, node: Any) -> bool:
        """Whether an executor has a node, and is being spun at this moment."""
        spinner = self.spinner_of(executor)
        is_spun = spinner is not None and bool(spinner.spins or spinner.waits or spinner.busy)
        return is_spun and node in executor.get_nodes()

    def _know(self, executor: Any, threads: int) -> Spinner:
        kind = type(executor).__name__
        spinner = Spinner(self._recorder.new_id(), threads, asks_groups=kind != "EventsExecutor")
        self._recorder.put("executor", now(), spinner.number, kind, threads)
        self._spinners[executor] = spinner
        with suppress(AttributeError):  # one made of C++ takes no attributes
            setattr(executor, STATE, spinner)
        return spinner

    def _work_for(self, spinner: Spinner) -> Callable[[], None]:
        def begin() -> None:
            here = self._recorder.here
            here.spinner, here.executor = spinner, spinner.number

        return begin


def _call_into_rclpy() -> tuple[str, str, int, bool]:
    """The function of rclpy's that the program called on this thread, the file and line of the call.

    The last item is whether the call has no timeout.
    """
    function, timeout, frame = "", None, sys._getframe(1)
    while not is_own(frame):
        if frame.f_globals["__name__"].startswith("rclpy"):
            function, timeout = frame.f_code.co_name, frame.f_locals.get("timeout_sec")
        if frame.f_back is None:
            return function, "", 0, False
        frame = frame.f_back
    return function, frame.f_code.co_filename, frame.f_lineno, timeout is None or timeout < 0


def _itself(executor: Any, *_args: Any, **_kwargs: Any) -> Any:
    return executor
