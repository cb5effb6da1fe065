"""The probe: turns what happens in executors, queues and nodes into events on the trace.

It gives out the ids, and knows per thread which callback runs there. Every method is called with the
host's lock held or touches nothing shared, and does no more than append to the sink.
"""

import threading
from collections.abc import Callable
from itertools import count
from typing import TYPE_CHECKING, Any, NamedTuple

from sim.interpreter.exception_text import error_line
from sim.interpreter.function_marks import sends_responses
from sim.probes.callbacks import callback_name, written_at
from sim.probes.own_code import call_into_ros, has_timeout, place_of_caller, raised_at
from sim.probes.traced import MessageContents, TracedEntity
from sim.trace import events
from sim.trace.events import (
    AnyEvent,
    CallbackEnded,
    CallbackStarted,
    GroupKind,
    Reason,
    Severity,
)

if TYPE_CHECKING:
    from sim.clock import RunClock


class _Here(threading.local):
    """What runs on the calling thread. ``everywhere`` gets what runs on each thread, by its identifier."""

    thread = 0
    entity = 0
    executor = 0
    begun = 0
    """Callbacks that began or went on on this thread."""

    def __init__(self, everywhere: dict[int, dict[str, int]]) -> None:
        everywhere[threading.get_ident()] = self.__dict__


class RunningCallback(NamedTuple):
    """What runs on a thread; ``begun`` distinguishes it from later calls there."""

    entity: int
    thread: int
    begun: int


class Probe:
    """Records a traced program's doings. ``sink`` takes events in order; appending must be thread-safe.

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
        self._threads = count(1)
        self._nodes = count(1)
        self._groups = count(1)
        self._entities = count(1)
        self._executors = count(1)
        self._messages = count(1)
        self._calls = count(1)

    def message_id(self) -> int:
        """A new id for a message on its way."""
        return next(self._messages)

    def call_id(self) -> int:
        """A new id for a service call."""
        return next(self._calls)

    def executor_made(self, kind: str, threads: int) -> int:
        """An executor was made; returns its id."""
        executor = next(self._executors)
        self._sink(events.ExecutorAppeared(self._now(), executor, kind, threads))
        return executor

    def works_for(self, executor: int) -> None:
        """The calling thread is a worker of an executor."""
        self._here.executor = executor

    def node_made(self, name: str) -> int:
        """A node was made; returns its id."""
        node = next(self._nodes)
        self._sink(events.NodeAppeared(self._now(), node, name))
        return node

    def entity_made(self, entity: TracedEntity) -> None:
        """An entity was made; its group appears with its first entity."""
        if not entity.traced:
            return
        now = self._now()
        group = self._group_id(now, entity)
        entity.trace_id = next(self._entities)
        name, file, first, last = written_at(entity.shown_callback())
        self._sink(
            events.EntityAppeared(
                now,
                entity.trace_id,
                entity.node.trace_id,
                group,
                entity.kind,
                entity.name,
                name,
                file,
                first,
                last,
                entity.depth,
                entity.period,
                entity.interface_type,
                self.place_of_call(),
            )
        )

    def _group_id(self, now: int, entity: TracedEntity) -> int:
        group = entity.callback_group
        if group.trace_id == 0:
            group.trace_id = next(self._groups)
            kind = group.trace_kind
            class_name = type(group).__name__
            self._sink(
                events.GroupAppeared(now, group.trace_id, entity.node.trace_id, GroupKind(kind), class_name)
            )
        return group.trace_id

    def entity_gone(self, entity: TracedEntity) -> None:
        """An entity was destroyed."""
        if not entity.traced:
            return
        self.wait_ended(entity)
        self._sink(events.EntityGone(self._now(), entity.trace_id))

    def ready(self, entity: TracedEntity, depth: int, message: int) -> None:
        """Something arrived for an entity."""
        if entity.traced:
            self._sink(events.EntityReady(self._now(), entity.trace_id, depth, message))

    def dropped(self, entity: TracedEntity, depth: int, message: int) -> None:
        """A full queue lost its oldest message, or one expired in it."""
        if entity.traced:
            self._sink(events.MessageDropped(self._now(), entity.trace_id, depth, message))

    def waits(
        self, entity: TracedEntity, reason: Reason, holder: TracedEntity | None, workers_busy: bool
    ) -> None:
        """A ready callback does not run; recorded when that is new or its reason changed."""
        state = (reason, 0 if holder is None else holder.trace_id, workers_busy)
        if entity.traced and entity.wait_shown != state:
            entity.wait_shown = state
            self._sink(events.WaitStarted(self._now(), entity.trace_id, entity.ready_since, *state))

    def wait_ended(self, entity: TracedEntity) -> None:
        """A callback waits no longer."""
        if entity.wait_shown is not None:
            entity.wait_shown = None
            self._sink(events.WaitEnded(self._now(), entity.trace_id))

    def callback_started(self, entity: TracedEntity, message: int, age: int, depth: int) -> int:
        """A callback begins on the calling thread; returns what ran there until now."""
        here = self._here
        outer, here.entity = here.entity, entity.trace_id
        here.begun += 1
        if entity.traced:
            thread = here.thread or self.thread()
            self._sink(CallbackStarted(self._now(), entity.trace_id, thread, message, age, depth))
        return outer

    def callback_ended(self, entity: TracedEntity, outer: int) -> None:
        """The callback that ran on the calling thread ended; ``outer`` runs there again."""
        here = self._here
        here.entity = outer
        if entity.traced:
            self._sink(CallbackEnded(self._now(), entity.trace_id, here.thread or self.thread()))

    def callback_here(self) -> int:
        """The entity whose callback runs on the calling thread; 0 for none."""
        return self._here.entity

    def running(self) -> dict[int, RunningCallback]:
        """The callbacks that run now, by the identifier of their thread; any thread may call this."""
        return {
            ident: RunningCallback(here["entity"], here.get("thread", 0), here.get("begun", 0))
            for ident, here in list(self._everywhere.items())
            if here.get("entity") and here.get("thread")
        }

    def many_made(self, number: int, kind: str) -> None:
        """A callback on the calling thread has given a node so many of a kind."""
        text = (
            f"a node has {number:,} {kind}, and its callbacks make more ({place_of_caller()}): each stays "
            "until it is destroyed; make what the node needs once, in __init__"
        )
        self._sink(events.Notice(self._now(), Severity.WARN, text))

    def node_destroyed_by_itself(self, name: str, entity: TracedEntity) -> None:
        """A callback of a node's, which runs on the calling thread, destroys the node."""
        callback = entity.shown_callback()
        own = entity.name if callback is None else callback_name(callback)
        text = (
            f"{name} destroyed itself in its own callback {own} ({place_of_caller()}): this call goes on to "
            "its end, and no callback of the node runs again; to end the program, call rclpy.shutdown() there"
        )
        self._sink(events.Notice(self._now(), Severity.WARN, text))

    def parameter_overruled(self, name: str) -> None:
        """A parameter callback on the calling thread sets a parameter that is being set."""
        problem = f"a parameter callback sets '{name}' while that is being set ({place_of_caller()})"
        advice = "return the value from a pre-set callback, or refuse what was asked for"
        text = f"{problem}: what was asked for is stored last; {advice}"
        entity, kind = self._here.entity, events.NoticeKind.OVERRULED
        self._sink(
            events.Notice(self._now(), Severity.WARN, text, entity, kind=kind, problem=problem, advice=advice)
        )

    def spin_clashed(self, node: int = 0) -> None:
        """The calling thread asked to spin what is being spun; ``node`` was taken from who spins it."""
        here, endless = self._here.entity, not has_timeout()
        self._sink(events.SpinClashed(self._now(), here, node, *call_into_ros(), endless))

    def callback_suspended(self, entity: TracedEntity, outer: int) -> None:
        """A coroutine callback awaits something and leaves the calling thread."""
        self._here.entity = outer
        if entity.traced:
            self._sink(events.CallbackSuspended(self._now(), entity.trace_id, self.thread()))

    def callback_resumed(self, entity: TracedEntity) -> int:
        """A coroutine callback goes on on the calling thread; returns what ran there until now."""
        outer, self._here.entity = self._here.entity, entity.trace_id
        self._here.begun += 1
        if entity.traced:
            self._sink(events.CallbackResumed(self._now(), entity.trace_id, self.thread()))
        return outer

    def callback_failed(self, entity: TracedEntity, error: BaseException) -> None:
        """A callback raised."""
        file, line = raised_at(error)
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

    @property
    def keeps_messages(self) -> bool:
        """Whether published messages are looked at later, so that nobody may be handed them to change."""
        return self._contents is not None and self._contents.keeps_messages

    def published(self, message: int, topic: str, node: int, data: Any, qos: Any) -> None:
        """A message left a publisher that offers ``qos``."""
        now = self._now()
        self._sink(events.Published(now, message, topic, node, self._here.entity))
        if self._contents is not None and self._contents.wanted:
            for event in self._contents.events(now, message, topic, data, qos):
                self._sink(event)

    def service_called(self, call: int, service: str, request: object) -> None:
        """A request left for a service."""
        self._sink(events.ServiceCalled(self._now(), call, service, self._here.entity, repr(request)))

    def service_replied(self, call: int, service: str, response: object) -> None:
        """A service answered."""
        self._sink(events.ServiceReplied(self._now(), call, service, repr(response)))

    def request_lost(self, call: int, service: str) -> None:
        """A request found nobody that offers its service."""
        self._sink(events.RequestLost(self._now(), call, service))

    def place_of_call(self) -> tuple[str, int]:
        """File and line of the learner's code that calls on this thread; empty for what is not traced."""
        _, file, line = call_into_ros()
        return file, line

    def qos_mismatched(
        self, topic: str, node: int, entity: int, policy: str, ends: tuple[tuple[str, int], tuple[str, int]]
    ) -> None:
        """A publisher and a subscription, made at ``ends``, do not match; 0 for one outside the program."""
        self._sink(events.QosMismatched(self._now(), topic, node, entity, policy, *ends))

    def call_blocked(self, call: int, service: str) -> None:
        """The calling thread stands still until a reply comes."""
        self._sink(events.CallBlocked(self._now(), call, self.thread(), self._here.entity, service))

    def call_unblocked(self, call: int) -> None:
        """The calling thread goes on after ``call_blocked``."""
        self._sink(events.CallUnblocked(self._now(), call, self.thread()))

    def logged(self, severity: Severity, logger: str, text: str) -> None:
        """A log line was written."""
        thread = self._here.thread or self.thread()
        self._sink(events.Logged(self._now(), severity, logger, text, thread, self._here.entity))

    def thread(self) -> int:
        """The id of the calling thread; it appears on the trace when first asked for."""
        here = self._here
        if here.thread == 0:
            here.thread = next(self._threads)
            thread = threading.current_thread()
            process = getattr(thread, "ros_process", None)
            number = 0 if process is None else process.number
            self._sink(events.ThreadAppeared(self._now(), here.thread, thread.name, number, here.executor))
        return here.thread


class SilentProbe(Probe):
    """Records nothing."""

    visible = False

    def __init__(self, clock: "RunClock") -> None:
        super().__init__(clock, _forget)

    def place_of_call(self) -> tuple[str, int]:
        """Nowhere: it is no part of the program."""
        return "", 0


class PublishingProbe(SilentProbe):
    """Records only messages and replies: the robot's driver is no part of the program, what it sends is.

    ``with_calls`` has it record the calls of services too, as of a line in the shell.
    """

    def __init__(self, clock: "RunClock", program: Probe, *, with_calls: bool = False) -> None:
        super().__init__(clock)
        self._program = program
        self._with_calls = with_calls

    def message_id(self) -> int:
        """A new id for a message, among the program's."""
        return self._program.message_id()

    def call_id(self) -> int:
        """A new id for a service call, among the program's."""
        return self._program.call_id()

    @property
    def keeps_messages(self) -> bool:
        """Whether published messages are looked at later."""
        return self._program.keeps_messages

    def published(self, message: int, topic: str, node: int, data: Any, qos: Any) -> None:
        """A message left a publisher; the trace names no node for it."""
        self._program.published(message, topic, 0, data, qos)

    def service_replied(self, call: int, service: str, response: object) -> None:
        """A service answered."""
        self._program.service_replied(call, service, response)

    def service_called(self, call: int, service: str, request: object) -> None:
        """A request left for a service."""
        if self._with_calls:
            self._program.service_called(call, service, request)

    def request_lost(self, call: int, service: str) -> None:
        """A request found nobody that offers its service."""
        if self._with_calls:
            self._program.request_lost(call, service)


def _forget(_event: AnyEvent) -> None:
    """Take an event that nobody wants."""


def _is_missing_response(error: BaseException) -> bool:
    """Tell whether an exception was raised as a service's callback had returned no response."""
    return isinstance(error, TypeError) and sends_responses.raised(error)
