"""The model's probe: records what happens in executors, queues and nodes as events of the trace.

It gives out the ids, and keeps per thread which callback runs there. Every method is called with the host's
lock held or uses nothing shared, and only appends to the sink.
"""

import sys
import threading
from collections.abc import Callable, Sequence
from itertools import count
from typing import TYPE_CHECKING, Any, NamedTuple

from sim.interpreter.exception_text import error_line
from sim.interpreter.function_marks import sends_responses
from sim.probes.on_path.cbtui_probe.naming import written_at
from sim.probes.on_path.cbtui_probe.own_lines import awaiting_frames, raised_at
from sim.probes.own_code import call_into_ros, has_timeout, is_own
from sim.probes.traced import MessageContents, TracedEntity
from sim.probes.usage_warnings import UsageWarnings
from sim.trace import events
from sim.trace.events import AnyEvent, CallbackEnded, CallbackStarted, GroupKind, Reason, Severity

if TYPE_CHECKING:
    from sim.clock import RunClock


class _Here(threading.local):
    """The state of the calling thread. ``everywhere`` gets the state of each thread, by its identifier."""

    thread = 0
    entity = 0
    executor = 0
    begun = 0
    """How many callbacks have started or were resumed on this thread."""

    def __init__(self, everywhere: dict[int, dict[str, int]]) -> None:
        everywhere[threading.get_ident()] = self.__dict__


class RunningCallback(NamedTuple):
    """The callback that runs on a thread; ``begun`` distinguishes it from later calls there."""

    entity: int
    thread: int
    begun: int


class Probe:
    """Records what a traced program does. ``sink`` takes events in order; appending must be thread-safe.

    ``contents`` makes the events that tell what messages hold (None: nobody ever wants that).
    """

    visible = True

    def __init__(
        self, clock: "RunClock", sink: Callable[[AnyEvent], None], contents: MessageContents | None = None
    ) -> None:
        self._now = clock.now
        self._sink = sink
        self._contents = contents
        self._everywhere: dict[int, dict[str, int]] = {}
        self._here = _Here(self._everywhere)
        self.usage = UsageWarnings(self._now, self._here, self._warn)
        self._threads = count(1)
        self._nodes = count(1)
        self._groups = count(1)
        self._entities = count(1)
        self._executors = count(1)
        self._messages = count(1)
        self._calls = count(1)

    def message_id(self) -> int:
        """A new id for a message."""
        return next(self._messages)

    def call_id(self) -> int:
        """A new id for a service call."""
        return next(self._calls)

    def executor_made(self, kind: str, threads: int) -> int:
        """Record a new executor; returns its id."""
        executor = next(self._executors)
        self._sink(events.ExecutorAppeared(self._now(), executor, kind, threads))
        return executor

    def works_for(self, executor: int) -> None:
        """Note that the calling thread is a worker of an executor."""
        self._here.executor = executor

    def node_made(self, name: str) -> int:
        """Record a new node; returns its id."""
        node = next(self._nodes)
        self._sink(events.NodeAppeared(self._now(), node, name))
        return node

    def entity_made(self, entity: TracedEntity) -> None:
        """Record a new entity; its group is recorded with its first entity."""
        if not entity.traced:
            return
        now = self._now()
        group = self._group_id(now, entity)
        entity.trace_id = next(self._entities)
        callback, place = entity.shown_callback(), self.place_of_call()
        self._sink(
            events.EntityAppeared(
                now,
                entity.trace_id,
                entity.node.trace_id,
                group,
                entity.kind,
                entity.name,
                *written_at(callback),
                entity.depth,
                entity.period,
                entity.interface_type,
                place,
            )
        )
        self.usage.callback_made(callback, place, entity.trace_id)

    def _group_id(self, now: int, entity: TracedEntity) -> int:
        group = entity.callback_group
        if group.trace_id == 0:
            group.trace_id = next(self._groups)
            kind, of = GroupKind(group.trace_kind), entity.node.trace_id
            name, is_own = type(group).__name__, group.is_own
            self._sink(events.GroupAppeared(now, group.trace_id, of, kind, name, is_own))
        return group.trace_id

    def entity_gone(self, entity: TracedEntity) -> None:
        """Record that an entity was destroyed."""
        if not entity.traced:
            return
        self.wait_ended(entity)
        self._sink(events.EntityGone(self._now(), entity.trace_id))

    def ready(self, entity: TracedEntity, depth: int, message: int) -> None:
        """Record that something has arrived for an entity."""
        if entity.traced:
            self._sink(events.EntityReady(self._now(), entity.trace_id, depth, message))

    def timer_cancelled(self, entity: TracedEntity) -> None:
        """Record that a timer was cancelled."""
        if entity.traced:
            self._sink(events.TimerCancelled(self._now(), entity.trace_id))

    def timer_reset(self, entity: TracedEntity) -> None:
        """Record that a cancelled timer was reset."""
        if entity.traced:
            self._sink(events.TimerReset(self._now(), entity.trace_id))

    def dropped(self, entity: TracedEntity, depth: int, message: int) -> None:
        """Record that a queue lost a message: the oldest of a full queue, or one that expired."""
        if entity.traced:
            self._sink(events.MessageDropped(self._now(), entity.trace_id, depth, message))

    def waits(
        self, entity: TracedEntity, reason: Reason, holder: TracedEntity | None, busy: bool, began: int
    ) -> None:
        """Record that a ready callback does not run, if that is new, or the reason, which has ``began``."""
        state, before = (reason, 0 if holder is None else holder.trace_id, busy), entity.wait_shown
        if entity.traced and before != state:
            entity.wait_shown = state
            is_other = before is not None and before[:2] != state[:2]
            t = max(began, entity.ready_since) if is_other else self._now()
            self._sink(events.WaitStarted(t, entity.trace_id, entity.ready_since, *state))

    def wait_ended(self, entity: TracedEntity) -> None:
        """Record that a callback no longer waits."""
        if entity.wait_shown is not None:
            entity.wait_shown = None
            self._sink(events.WaitEnded(self._now(), entity.trace_id))

    def callback_started(self, entity: TracedEntity, message: int, age: int, depth: int) -> int:
        """Record the start of a callback on the calling thread; returns the entity that ran there before."""
        here = self._here
        outer, here.entity = here.entity, entity.trace_id
        here.begun += 1
        if entity.traced:
            thread = here.thread or self.thread()
            self._sink(CallbackStarted(self._now(), entity.trace_id, thread, message, age, depth))
        return outer

    def callback_ended(self, entity: TracedEntity, outer: int) -> None:
        """Record the end of the callback on the calling thread; ``outer`` runs there again."""
        here = self._here
        here.entity = outer
        if entity.traced:
            self._sink(CallbackEnded(self._now(), entity.trace_id, here.thread or self.thread()))

    def callback_here(self) -> int:
        """The entity whose callback runs on the calling thread; 0 for none."""
        return self._here.entity

    def running_here(self) -> tuple[int, int, int]:
        """The callback that runs on the calling thread, quick to ask; its entity is 0 for none."""
        return (here := self._here).entity, here.thread, here.begun

    def running(self) -> dict[int, RunningCallback]:
        """The callbacks that run now, by the identifier of their thread; any thread may call this."""
        return {
            ident: RunningCallback(here["entity"], here.get("thread", 0), here.get("begun", 0))
            for ident, here in list(self._everywhere.items())
            if here.get("entity") and here.get("thread")
        }

    def threads(self) -> dict[int, int]:
        """The ids of the recorded threads, by identifier; any thread may call this."""
        return {ident: here.get("thread", 0) for ident, here in list(self._everywhere.items())}

    def _warn(self, text: str, entity: int = 0, **more: Any) -> None:
        self._sink(events.Notice(self._now(), Severity.WARN, text, entity, **more))

    def times_kept(self, node: int, length: int, attributes: Sequence[str]) -> None:
        """Record that a node still holds times of before its clock was set back, by so much."""
        self._sink(events.TimesKept(self._now(), node, length, tuple(attributes)))

    def spin_clashed(self, node: int = 0, *, refused: bool = False) -> None:
        """Record that the calling thread spins what is being spun; ``node`` was taken from that executor."""
        here, endless = self._here.entity, not has_timeout()
        self._sink(events.SpinClashed(self._now(), here, node, *call_into_ros(), endless, refused))

    def callback_suspended(self, entity: TracedEntity, outer: int, coroutine: object = None) -> None:
        """Record that a callback is suspended where its coroutine awaits, and leaves the calling thread."""
        self._here.entity = outer
        if entity.traced:
            frames = awaiting_frames(coroutine, is_own)
            self._sink(events.CallbackSuspended(self._now(), entity.trace_id, self.thread(), frames))

    def callback_resumed(self, entity: TracedEntity) -> int:
        """Record that a coroutine callback is resumed; returns the entity that ran on the thread before."""
        outer, self._here.entity = self._here.entity, entity.trace_id
        self._here.begun += 1
        if entity.traced:
            self._sink(events.CallbackResumed(self._now(), entity.trace_id, self.thread()))
        return outer

    def callback_failed(self, entity: TracedEntity, error: BaseException) -> None:
        """Record the exception of a callback."""
        file, line = raised_at(error, is_own)
        self._sink(
            events.CallbackFailed(
                self._now(),
                entity.trace_id,
                self.thread(),
                error_line(error),
                file,
                line,
                type(error).__name__,
                _is_missing_response(error),
            )
        )

    def exception_surfaced(self, error: BaseException) -> None:
        """Record that a pool's executor raises a callback's exception on the calling thread."""
        surfaced = events.ExceptionSurfaced(
            self._now(), self.thread(), error_line(error), *raised_at(error, is_own)
        )
        self._sink(surfaced)

    @property
    def keeps_messages(self) -> bool:
        """Whether published messages are read later, so that a subscription must not get the same object."""
        return self._contents is not None and self._contents.keeps_messages

    def published(self, message: int, topic: str, node: int, data: Any, qos: Any) -> None:
        """Record a published message; ``qos`` is what its publisher offers."""
        now = self._now()
        self._sink(events.Published(now, message, topic, node, self._here.entity))
        if self._contents is not None and self._contents.wanted:
            for event in self._contents.events(now, message, topic, data, qos):
                self._sink(event)

    def service_called(self, call: int, service: str, request: object) -> None:
        """Record a request to a service."""
        self._sink(events.ServiceCalled(self._now(), call, service, self._here.entity, repr(request)))

    def service_replied(self, call: int, service: str, response: object) -> None:
        """Record the reply of a service."""
        self._sink(events.ServiceReplied(self._now(), call, service, repr(response)))

    def request_lost(self, call: int, service: str) -> None:
        """Record a request whose service nobody offers."""
        self._sink(events.RequestLost(self._now(), call, service))

    def place_of_call(self) -> tuple[str, int]:
        """The file and line of the learner's code that calls rclpy on this thread; empty if there is none."""
        _, file, line = call_into_ros()
        return file, line

    def qos_mismatched(
        self, topic: str, node: int, entity: int, policy: str, ends: tuple[tuple[str, int], tuple[str, int]]
    ) -> None:
        """Record that the QoS of two ``ends`` is incompatible; an id of 0 is outside the program."""
        self._sink(events.QosMismatched(self._now(), topic, node, entity, policy, *ends))

    def call_blocked(self, call: int, service: str) -> None:
        """Record that the calling thread blocks until a reply comes."""
        self._sink(events.CallBlocked(self._now(), call, self.thread(), self._here.entity, service))

    def call_unblocked(self, call: int) -> None:
        """Record that the calling thread no longer blocks."""
        self._sink(events.CallUnblocked(self._now(), call, self.thread()))

    def logged(self, severity: Severity, logger: str, text: str) -> None:
        """Record a log line."""
        thread = self._here.thread or self.thread()
        self._sink(events.Logged(self._now(), severity, logger, text, thread, self._here.entity))

    def thread(self) -> int:
        """The id of the calling thread, which is recorded at the first use."""
        here = self._here
        if here.thread == 0:
            here.thread = next(self._threads)
            sys.set_coroutine_origin_tracking_depth(1)  # of this thread
            thread = threading.current_thread()
            process = getattr(thread, "ros_process", None)
            number = 0 if process is None else process.number
            self._sink(events.ThreadAppeared(self._now(), here.thread, thread.name, number, here.executor))
        return here.thread


class SilentProbe(Probe):
    """Records nothing."""

    visible = False

    def __init__(self, clock: "RunClock") -> None:
        super().__init__(clock, lambda _: None)

    def place_of_call(self) -> tuple[str, int]:
        """Return no place: the caller is no part of the program."""
        return "", 0


class PublishingProbe(SilentProbe):
    """Records only messages and replies, for the robot's driver, which is no part of the program.

    ``with_calls`` has it record service calls as well, for a line in the shell.
    """

    def __init__(self, clock: "RunClock", program: Probe, *, with_calls: bool = False) -> None:
        super().__init__(clock)
        self._program = program
        self._with_calls = with_calls

    def message_id(self) -> int:
        """A new id for a message, from the program's ids."""
        return self._program.message_id()

    def call_id(self) -> int:
        """A new id for a service call, from the program's ids."""
        return self._program.call_id()

    @property
    def keeps_messages(self) -> bool:
        """Whether published messages are read later."""
        return self._program.keeps_messages

    def published(self, message: int, topic: str, node: int, data: Any, qos: Any) -> None:
        """Record a published message, without a node."""
        self._program.published(message, topic, 0, data, qos)

    def service_replied(self, call: int, service: str, response: object) -> None:
        """Record the reply of a service."""
        self._program.service_replied(call, service, response)

    def service_called(self, call: int, service: str, request: object) -> None:
        """Record a request to a service, if calls are recorded."""
        if self._with_calls:
            self._program.service_called(call, service, request)

    def request_lost(self, call: int, service: str) -> None:
        """Record a request whose service nobody offers, if calls are recorded."""
        if self._with_calls:
            self._program.request_lost(call, service)


def _is_missing_response(error: BaseException) -> bool:
    """Whether an exception was raised because a service's callback returned no response."""
    return isinstance(error, TypeError) and sends_responses.raised(error)
