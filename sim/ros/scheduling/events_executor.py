"""rclpy's EventsExecutor: it has one queue of all events, and ignores callback groups.

Its rules are those of rclpy's C++ code (Jazzy 7.1.9). Measured on Jazzy 7.1.5 as well were: the order of
arrivals, timers called twice, exceptions, timeouts, tasks, guard conditions, entities destroyed while queued,
``call`` and ``shutdown`` in a callback. Only read from the code were: jumps of ROS time, waitables. The
wheels' own ``spin()`` never wakes, because its infinite deadline overflows; all measurements had timeouts.
Two orders that are random in rclpy are the order of creation here: of the entities found when a node is
added, and of timers that are due at the same moment.
"""

import traceback
from collections.abc import Coroutine, Iterable, Sequence
from functools import partial
from typing import Any, cast

from sim.clock import AutoResetEvent
from sim.interpreter.function_marks import sends_responses
from sim.probes.own_code import is_own
from sim.quantities.nanoseconds import wait_ns
from sim.ros.clocks.clock import Clock
from sim.ros.context.context import Context
from sim.ros.context.utilities import get_default_context, timeout_sec_to_nsec
from sim.ros.logging.logger import RcutilsLogger, get_logger
from sim.ros.scheduling.clock_timers import ClockTimers
from sim.ros.scheduling.entity import NEVER, Entity
from sim.ros.scheduling.event_queue import Appointment, EventQueue
from sim.ros.scheduling.executor import Executor
from sim.ros.scheduling.task import Future, Task
from sim.ros.scheduling.waitable_entity import WaitableEntity, poll_waitables
from sim.ros.scheduling.waiting_ends import ExternalShutdownException
from sim.trace.events import EntityKind

_PLURALS = {
    EntityKind.SUBSCRIPTION: "subscriptions",
    EntityKind.TIMER: "timers",
    EntityKind.CLIENT: "clients",
    EntityKind.SERVICE: "services",
}
_TASK = "task"
_REGISTRATION_ORDER = (*_PLURALS, EntityKind.WAITABLE)


class EventsExecutor(Executor):
    """Runs callbacks in the spinning thread, in the order in which messages, ticks and tasks arrived.

    Callback groups are ignored: no callback waits for one, and callbacks never overlap. Events that
    ``spin`` leaves in the queue run at the next spin. A timer's coroutine runs as a
    task. In some releases a subscription's coroutine never runs, and a service's raises TypeError.

    Raises:
        RuntimeError: out of ``spin``, when a node has a guard condition.
    """

    already_spinning = "Attempt to spin an already-spinning Executor"
    replies_in_tasks = True  # rclpy sends them in done-callbacks

    def __init__(self, *, context: Context | None = None) -> None:
        chosen = get_default_context() if context is None else context
        self._queue = EventQueue(chosen.host.clock, chosen.host.lock)
        self._update_queued = False
        super().__init__(context=chosen)
        self._runner.asks_groups = self._runner.asks_in_next_cycle = False
        self._registered: dict[Entity, None] = {}
        self._timers: dict[Clock, ClockTimers] = {}
        self._stops_after_one = False
        self._postponed = False
        self._taken: Entity | None = None
        self._parked: list[Task[Any]] = []
        self._queued_waitables: set[Entity] = set()
        self._next_poll: Appointment | None = None
        self._end_signals: list[AutoResetEvent] = []

    # Spinning

    def spin(self) -> None:
        """Run callbacks until the context ends or the executor is shut down.

        Raises:
            RuntimeError: it is already spinning.
            ExternalShutdownException: the context ended.
        """
        self._run_events(None)

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """Run events up to and including the first callback's, even if that has nothing to take.

        It waits at most ``timeout_sec`` seconds (None: for ever; negative: not at all).
        """
        self._run_events(timeout_sec, stop_after_one=True)

    def spin_until_future_complete(self, future: Future[Any], timeout_sec: float | None = None) -> None:
        """Run callbacks until the future is done.

        After ``timeout_sec`` seconds it returns when the queue is empty, which a busy queue never is.
        """
        self._run_until_complete(future, timeout_sec, stop_after_one=False)

    def spin_once_until_future_complete(self, future: Future[Any], timeout_sec: float | None = None) -> None:
        """Run events up to and including the first callback's, unless the future is done before."""
        self._run_until_complete(future, timeout_sec, stop_after_one=True)

    def _refuses_second_spin(self) -> bool:
        return True

    def _run_until_complete(
        self, future: Future[Any], timeout_sec: float | None, *, stop_after_one: bool
    ) -> None:
        def stop(_future: Future[Any]) -> None:
            self._stop()

        future.add_done_callback(stop)
        self._run_events(timeout_sec, stop_after_one=stop_after_one)
        future.remove_done_callback(stop)

    def _run_events(self, timeout_sec: float | None, *, stop_after_one: bool = False) -> None:
        """Run events until stopped, or until the timeout is over and the queue is empty.

        After an exception a stopped queue stays stopped: the next spin returns at once.
        """
        try:
            with self._enter_spin():
                self._stops_after_one = stop_after_one
                deadline = None
                if timeout_sec is not None:
                    deadline = self._clock.now() + wait_ns(max(timeout_sec, 0.0))
                    self._clock.poll()
                while (event := self._queue.next(deadline)) is not None:
                    event()
                    if self._polls_waitables:
                        self._queue_ready_waitables()
                self._queue.stopped = False
        finally:
            for signal in self._end_signals:
                signal.set()
        if not self._context.ok():
            raise ExternalShutdownException

    def _stop(self) -> None:
        with self._lock:
            self._queue.stop()

    def _stop_if_one_is_enough(self) -> None:
        if self._stops_after_one:
            self._stop()

    def shutdown(self, timeout_sec: float | None = None) -> bool:
        """Stop spinning, and remove all nodes; False if ``timeout_sec`` seconds were not enough.

        A callback that shuts down its own executor waits for itself.
        """
        nanoseconds = timeout_sec_to_nsec(timeout_sec)
        ended = self._clock.auto_reset_event()
        with self._lock:
            self._queue.stop()
            self._end_signals.append(ended)
        if self._spinning and not ended.wait(None if nanoseconds < 0 else self._clock.now() + nanoseconds):
            return False
        self._end_signals.remove(ended)
        with self._lock:
            self._let_all_go()
        return True

    # Its entities

    def wake(self) -> None:
        """Queue an update of the entities; new entities are served after that update."""
        with self._lock:
            if not self._update_queued:
                self._update_queued = True
                self._queue.put(self._update)

    def _update(self) -> None:
        with self._lock:
            self._update_queued = False
            if self._context.ok():
                self._register(each for node in self._nodes for each in node._agenda.entities if each.served)
            else:
                self._let_all_go()

    def _let_all_go(self) -> None:
        for node in self.get_nodes():
            self.remove_node(node)
        self._register(())
        self._queue.stop()

    def _register(self, entities: Iterable[Entity]) -> None:
        wanted = dict.fromkeys(entities)
        if any(each.kind is EntityKind.GUARD or _waits_for_guards(each) for each in wanted):
            raise RuntimeError("Guard conditions not supported")
        added = [each for each in wanted if each not in self._registered]
        for each in sorted(added, key=lambda each: _REGISTRATION_ORDER.index(each.kind)):
            self._registered[each] = None
            self._register_entity(each)
        for each in [each for each in self._registered if each not in wanted]:
            del self._registered[each]
            if each.destroyed:  # its handle was in use: others knew it, and it got messages
                each.become_idle()
                each.removed()
            if each.kind is EntityKind.TIMER:
                clock = _clock_of(each)
                self._timers[clock].remove(each)
                if not self._timers[clock].timers:
                    del self._timers[clock]

    def _register_entity(self, entity: Entity) -> None:
        if entity.kind is EntityKind.TIMER:
            clock = _clock_of(entity)
            if clock not in self._timers:
                self._timers[clock] = ClockTimers(
                    clock, self._clock, self._lock, self._queue, self._call_timer
                )
            self._timers[clock].add(entity)
        elif arrivals := entity.arrivals():
            self._queue.put(partial(self._serve, entity, arrivals))
        elif entity.due < NEVER:
            self._timer_set(entity)

    # Notifications, with the host's lock held

    def _entity_ready(self, entity: Entity) -> None:
        """Queue an event for an item that arrived. Timers are checked when due, and when time jumps."""
        if entity in self._registered and entity.kind is not EntityKind.TIMER:
            self._queue.put(partial(self._serve, entity, (entity.arrived_at,)))

    _entity_has_more = _entity_ready

    def _timer_set(self, timer: Entity) -> None:
        if timer not in self._registered or timer is self._taken:
            return
        if timer.kind is EntityKind.TIMER:
            timer.reset_unheard = False
            self._timers[_clock_of(timer)].check_soon()
        else:
            self._queue.at(timer.due, partial(_report_due, timer, timer.due))

    def _expiry_set(self, clock: Clock) -> None:
        if clock in self._timers:
            self._timers[clock].check_soon()

    def _wake(self) -> None:
        """Do nothing: what is ready is in the queue."""

    def _resume(self, task: Task[Any]) -> None:
        with self._lock:
            self._queue.put(partial(self._step, task))

    def _resume_at_wake_up(self, task: Task[Any]) -> None:
        """Resume a task that awaits something unknown after the next callback, also one that raises."""
        with self._lock:
            self._parked.append(task)

    def _waitables_changed(self) -> None:
        self._polls_waitables = any(node._agenda.polled for node in self._nodes)
        self.wake()

    # Events

    def _serve(self, entity: Entity, arrivals: Sequence[Entity | None]) -> None:
        """Run the entity's callback for each arrival that has not been dropped since."""
        if entity not in self._registered:
            return
        self._stop_if_one_is_enough()
        try:
            for arrived in arrivals:
                self._call(entity, arrived)
        finally:
            self._go_on_with_parked()

    def _call_timer(self, timer: Entity) -> None:
        self._postponed = False
        try:
            self._call(timer)
            if not self._postponed:
                self._stop_if_one_is_enough()
        finally:
            self._go_on_with_parked()

    def _call(self, entity: Entity, arrived: Entity | None = None) -> None:
        with self._lock:
            self._taken = entity
            entity.expect(arrived)
            self._queued_waitables.discard(entity)
            taken = self._runner.take(entity, self._clock.now())
            self._taken = None
            if taken is None:
                return
            started = self._runner.start((entity, taken))
        try:
            self._runner.run(started)
        except Exception as error:
            if not sends_responses.raised(error):
                _log(error, entity.node.get_logger(), _PLURALS.get(entity.kind, _TASK))
            raise

    def _coroutine_returned(self, entity: Entity, coroutine: Coroutine[Any, Any, Any], outer: int) -> None:
        """A callback has returned a coroutine."""
        runs_all = self._profile.events_executor_runs_coroutines
        if runs_all or entity.kind not in (EntityKind.SUBSCRIPTION, EntityKind.SERVICE):
            self._postponed = True
            self._runner.postpone(entity, coroutine, outer)
        else:
            self._runner.drop(entity, coroutine, outer)

    def _step(self, task: Task[Any]) -> None:
        """Run a task up to its next await; what it awaits queues it again."""
        self._stop_if_one_is_enough()
        with self._lock:
            self._runner.begin(task, self._clock.now())
            self._runner.start(task)
        try:
            self._runner.run(task)
        except Exception as error:
            nodes = self.get_nodes()
            logger = nodes[0].get_logger() if len(nodes) == 1 else get_logger("UNKNOWN")
            _log(error, logger, _TASK)
            if len(nodes) == 1:
                logger.fatal("rclpy 7.1.5 and 9.1.2 end the process here: segmentation fault (rclpy#1641)")
            raise

    def _go_on_with_parked(self) -> None:
        with self._lock:
            parked, self._parked = self._parked, []
            for task in parked:
                self._resume(task)

    # A program's waitables

    def _queue_ready_waitables(self) -> None:
        """Poll the program's waitables, and queue those that are ready."""
        due = poll_waitables(self, self.get_nodes())
        with self._lock:
            if self._next_poll is not None:
                self._next_poll.call_off()
            self._next_poll = None if due is None else self._queue.at(due, self.wake)
            for each in [each for node in self._nodes for each in node._agenda.polled]:
                if each.pending and each not in self._queued_waitables:
                    self._queued_waitables.add(each)
                    self._entity_ready(each)


def _clock_of(timer: Entity) -> Clock:
    return cast("Any", timer).clock  # type: ignore[no-any-return]


def _report_due(entity: Entity, due: int) -> None:
    if entity.falls_due(due):
        entity.become_ready(due)


def _waits_for_guards(entity: Entity) -> bool:
    return isinstance(entity, WaitableEntity) and entity.waitable.get_num_entities().num_guard_conditions > 0


def _log(error: Exception, logger: RcutilsLogger, kind: str) -> None:
    """Log an exception that ``spin`` raises, and the place in the program."""
    trace = error.__traceback__
    while trace is not None and not is_own(trace.tb_frame):
        trace = trace.tb_next
    logger.fatal(f"Exception in '{kind}' callback: {error}")
    logger.warning("Error occurred at:\n" + "".join(traceback.format_tb(trace)))
