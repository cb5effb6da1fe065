"""The timeline: everything that is known of a run, grown event by event and asked by time."""

from array import array
from bisect import bisect_left, bisect_right, insort
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from operator import attrgetter, itemgetter
from typing import Any, TypeAlias

from sim.trace import events as ev
from sim.trace.calls import Calls
from sim.trace.cast import Cast
from sim.trace.events import AnyEvent, EntityId, ExecutorId, GroupId, MessageId, NodeId, ThreadId
from sim.trace.execution import Execution
from sim.trace.history import History
from sim.trace.model import (
    Call,
    Entity,
    Executor,
    Group,
    Mark,
    Moment,
    Nanoseconds,
    Queue,
    Span,
    Thread,
    Wait,
    Window,
)
from sim.trace.queues import QueueHistory, place_of
from sim.trace.waiting import Waiting

TEXTS_KEPT = 4096

ShellEvent: TypeAlias = ev.LineGiven | ev.LineSaid | ev.LineEnded


class Timeline:
    """Everything that is known of a run so far; grows by batches, answers by time in O(log n).

    Times are nanoseconds since the run began. What is asked of a moment ``at`` holds after every event at or
    before ``at``: a call that took no time runs at no moment, and is found by its span. Windows include
    their start and exclude their end. Ids that are not known get empty answers.

    Events may come late by a little: answers stay in order of time. Not thread-safe: one owner (the UI
    thread, or the command line's main thread) extends and asks.
    """

    def __init__(self) -> None:
        self.started: ev.RunStarted | None = None
        self.ended: ev.RunEnded | None = None
        self.arena: ev.ArenaShown | None = None
        self.lost = 0
        self.contents_lost = 0
        self._end = 0
        self._cast = Cast()
        self._execution = Execution()
        self._waiting = Waiting()
        self._queues: defaultdict[EntityId, QueueHistory] = defaultdict(QueueHistory)
        self._dropped_at = array("q")
        self._messages = array("q")
        self._published_at = array("q")
        self._calls = Calls()
        self._marks: History[Mark] = History(attrgetter("at"))
        self._logs: History[ev.Logged | ev.Printed] = History(attrgetter("t"))
        self._shell: History[ShellEvent] = History(attrgetter("t"))
        self.completed: ev.LineCompleted | None = None
        self._notices: History[ev.Notice] = History(attrgetter("t"))
        self._texts: dict[str, str] = {}
        self._robot: History[ev.RobotMoved] = History(attrgetter("t"))
        self._velocities: History[ev.VelocityCommanded] = History(attrgetter("t"))
        self._scans: History[ev.Scanned] = History(attrgetter("t"))
        self._scan_of: dict[MessageId, ev.Scanned] = {}
        self._scans_seen: History[tuple[Nanoseconds, ev.Scanned]] = History(itemgetter(0))
        self._fold: dict[type, Callable[[Any], object]] = self._folding()

    def extend(self, events: Iterable[AnyEvent]) -> None:
        """Take in a batch; state after batches is the state after one batch of them all."""
        fold = self._fold
        end = self._end
        for event in events:
            fold[event.__class__](event)
            end = max(end, event.t)
        self._end = end

    # the cast

    @property
    def end(self) -> Nanoseconds:
        """Time of the latest event, 0 for an empty timeline."""
        return self._end

    @property
    def threads(self) -> dict[ThreadId, Thread]:
        """The threads, in order of appearance."""
        return self._cast.threads

    @property
    def executors(self) -> dict[ExecutorId, Executor]:
        """The executors, in order of appearance."""
        return self._cast.executors

    @property
    def nodes(self) -> dict[NodeId, str]:
        """The names of the nodes, in order of appearance."""
        return self._cast.nodes

    @property
    def groups(self) -> dict[GroupId, Group]:
        """The callback groups, in order of appearance, which is the order of their letters."""
        return self._cast.groups

    @property
    def entities(self) -> dict[EntityId, Entity]:
        """The entities, in order of appearance; those that are gone stay."""
        return self._cast.entities

    def group_members(self, group: GroupId) -> tuple[Entity, ...]:
        """The entities of a group."""
        return self._cast.members(group)

    # intervals

    def spans_on(self, thread: ThreadId, window: Window) -> Sequence[Span]:
        """What a thread ran, in order of start; a nested call follows the one it is in."""
        return self._execution.on(thread, window)

    def spans_of(self, entity: EntityId, window: Window) -> Sequence[Span]:
        """Calls of an entity, in order of start; one that was suspended is several spans."""
        return self._execution.of(entity, window)

    def spans_in(self, group: GroupId, window: Window) -> Sequence[Span]:
        """Calls of a group's entities, in order of start."""
        return self._execution.inside(group, window)

    def waits_of(self, entity: EntityId, window: Window) -> Sequence[Wait]:
        """Waits of an entity, in order of start."""
        return self._waiting.of(entity, window)

    def drops_of(self, entity: EntityId, window: Window) -> int:
        """How many messages an entity's queue lost in the window."""
        return self._queues[entity].lost_in(window)

    def calls_of(self, entity: EntityId, window: Window) -> int:
        """How many calls of an entity's callback began in the window; going on after a suspension is none."""
        return self._execution.calls(entity, window)

    def calls_begun(self, entity: EntityId, window: Window) -> Sequence[Span]:
        """Where those calls begin, in order of start: the whole of each, or what lies before a suspension."""
        return self._execution.begun(entity, window)

    def busy(self, thread: ThreadId, window: Window) -> float:
        """Share of the window, 0 to 1, in which the thread ran callbacks; nothing is known past the end."""
        if window.length <= 0:
            return 0.0
        known = Window(window.start, min(window.end, self._end))
        return self._execution.busy(thread, known) / window.length

    # moments

    def moment(self, at: Nanoseconds) -> Moment:
        """Who runs, who waits and why, who holds which group, what is queued and which calls are out."""
        running = {thread: self._execution.innermost(thread, at) for thread in self.threads}
        waiting = {entity: self._waiting.at(entity, at) for entity in self.entities}
        return Moment(
            at,
            {thread: span for thread, span in running.items() if span is not None},
            {entity: wait for entity, wait in waiting.items() if wait is not None},
            {entity: self.queue(entity, at) for entity in self.entities},
            {group: self._holders(group, at) for group in self.groups},
            self._calls.pending(at),
        )

    def queue(self, entity: EntityId, at: Nanoseconds) -> Queue:
        """The queue of an entity."""
        return self._queues[entity].queue(at, self.published_at)

    def dropped(self, at: Nanoseconds) -> int:
        """How many messages all queues have lost by ``at``."""
        return bisect_right(self._dropped_at, at)

    def published_at(self, message: MessageId) -> Nanoseconds | None:
        """When a message was published; None for one that is not known to have been."""
        place = bisect_left(self._messages, message)
        if place < len(self._messages) and self._messages[place] == message:
            return self._published_at[place]
        return None

    def neighbour(self, at: Nanoseconds, entity: EntityId | None, step: int) -> Nanoseconds | None:
        """Time of the next (``step`` > 0) or previous event of an entity, or of any: never ``at`` itself.

        Events are starts and ends of callbacks (and where one is suspended and resumed), starts of waits,
        and drops. None if there is none on that side.
        """
        asked = self.entities if entity is None else (entity,)
        times = (time for each in asked for time in self._events_beside(each, at, step))
        return min(times, default=None) if step > 0 else max(times, default=None)

    # what was said, and the robot

    @property
    def calls(self) -> list[Call]:
        """The service calls, in order of sending."""
        return self._calls.sent.items

    @property
    def logs(self) -> list[ev.Logged | ev.Printed]:
        """Log lines and printed lines, in order."""
        return self._logs.items

    @property
    def shell(self) -> list[ShellEvent]:
        """The ``ros2`` lines that were given, what they wrote and how they ended, in order."""
        return self._shell.items

    def logs_until(self, at: Nanoseconds) -> int:
        """How many of ``logs`` had been written by ``at``."""
        return self._logs.until(at)

    @property
    def notices(self) -> list[ev.Notice]:
        """What the engine had to say, in order."""
        return self._notices.items

    def marks(self, window: Window) -> Sequence[Mark]:
        """Commands, calls, replies, notices and errors in the window."""
        return self._marks.within(window)

    def robot(self, at: Nanoseconds) -> ev.RobotMoved | None:
        """Where the robot was: the latest at or before ``at``."""
        return self._robot.latest(at)

    def command(self, at: Nanoseconds) -> ev.VelocityCommanded | None:
        """The velocity command in force: the latest at or before ``at``."""
        return self._velocities.latest(at)

    def trail(self, window: Window) -> Sequence[ev.RobotMoved]:
        """Where the robot was in the window."""
        return self._robot.within(window)

    def scan(self, at: Nanoseconds) -> ev.Scanned | None:
        """The latest true scan at or before ``at``."""
        return self._scans.latest(at)

    def scan_seen(self, at: Nanoseconds) -> ev.Scanned | None:
        """The scan whose message a callback last took, at or before ``at``."""
        seen = self._scans_seen.latest(at)
        return None if seen is None else seen[1]

    # folding

    def _folding(self) -> dict[type, Callable[[Any], object]]:
        return {
            ev.RunStarted: self._run_started,
            ev.RunEnded: self._run_ended,
            ev.ProcessAppeared: self._cast.add_process,
            ev.ProcessEnded: _pass_over,
            ev.ThreadAppeared: self._cast.add_thread,
            ev.ExecutorAppeared: self._cast.add_executor,
            ev.NodeAppeared: self._cast.add_node,
            ev.GroupAppeared: self._cast.add_group,
            ev.EntityAppeared: self._entity_appeared,
            ev.EntityGone: self._entity_gone,
            ev.EntityReady: self._ready,
            ev.MessageDropped: self._message_dropped,
            ev.WaitStarted: self._waiting.start,
            ev.WaitEnded: self._wait_ended,
            ev.CallbackStarted: self._callback_started,
            ev.CallbackEnded: self._execution.finish,
            ev.CallbackSuspended: self._execution.suspend,
            ev.CallbackResumed: self._execution.resume,
            ev.CallbackFailed: self._callback_failed,
            ev.Published: self._published,
            ev.TopicAppeared: _pass_over,
            ev.MessageSent: _pass_over,
            ev.ServiceCalled: self._service_called,
            ev.ServiceReplied: self._service_replied,
            ev.CallBlocked: _pass_over,
            ev.CallUnblocked: _pass_over,
            ev.Logged: self._logged,
            ev.Printed: self._logs.add,
            ev.ArenaShown: self._arena_shown,
            ev.RobotMoved: self._robot.add,
            ev.Scanned: self._scanned,
            ev.VelocityCommanded: self._velocities.add,
            ev.CommandGiven: self._command_given,
            ev.InputGiven: _pass_over,
            ev.TimeHalted: _pass_over,
            ev.LineGiven: self._line_given,
            ev.LineSaid: self._shell.add,
            ev.LineEnded: self._shell.add,
            ev.LineCompleted: self._line_completed,
            ev.Notice: self._noticed,
            ev.EventsLost: self._events_lost,
            ev.ContentsLost: self._contents_lost,
        }

    def _run_started(self, event: ev.RunStarted) -> None:
        self.started = event

    def _run_ended(self, event: ev.RunEnded) -> None:
        self.ended = event

    def _arena_shown(self, event: ev.ArenaShown) -> None:
        self.arena = event

    def _entity_appeared(self, event: ev.EntityAppeared) -> None:
        self._cast.add_entity(event)
        self._execution.join(event.entity, event.group)

    def _entity_gone(self, event: ev.EntityGone) -> None:
        self._waiting.finish(event.entity, event.t)
        self._queues[event.entity].become(event.t, 0)

    def _ready(self, event: ev.EntityReady) -> None:
        self._queues[event.entity].arrive(event.t, event.depth, event.message)

    def _message_dropped(self, event: ev.MessageDropped) -> None:
        self._queues[event.entity].lose(event.t, event.depth)
        insort(self._dropped_at, event.t)

    def _wait_ended(self, event: ev.WaitEnded) -> None:
        self._waiting.finish(event.entity, event.t)

    def _callback_started(self, event: ev.CallbackStarted) -> None:
        self._execution.start(event)
        self._queues[event.entity].become(event.t, event.depth)
        if event.message in self._scan_of:
            self._scans_seen.add((event.t, self._scan_of[event.message]))

    def _callback_failed(self, event: ev.CallbackFailed) -> None:
        self._execution.fail(event)
        entity = self.entities.get(event.entity)
        who = entity.spoken_name if entity else "a callback"
        self._marks.add(Mark(event.t, "error", f"{who} raised {event.error}"))

    def _published(self, event: ev.Published) -> None:
        if not self._messages or self._messages[-1] < event.message:
            self._messages.append(event.message)
            self._published_at.append(event.t)
        elif self.published_at(event.message) is None:
            place = place_of(self._messages, event.message)
            self._messages.insert(place, event.message)
            self._published_at.insert(place, event.t)

    def _service_called(self, event: ev.ServiceCalled) -> None:
        self._calls.send(event)
        self._marks.add(Mark(event.t, "call", f"{event.service} {event.request}"))

    def _service_replied(self, event: ev.ServiceReplied) -> None:
        self._calls.reply(event)
        self._marks.add(Mark(event.t, "reply", f"{event.service} {event.response}"))

    def _logged(self, event: ev.Logged) -> None:
        self._logs.add(
            ev.Logged(
                event.t,
                event.severity,
                self._shared(event.logger),
                self._shared(event.text),
                event.thread,
                event.entity,
            )
        )

    def _shared(self, text: str) -> str:
        """One object for equal texts: a log repeats itself, and every decoded event brings its own copy."""
        if len(self._texts) > TEXTS_KEPT:
            self._texts.clear()
        return self._texts.setdefault(text, text)

    def _scanned(self, event: ev.Scanned) -> None:
        self._scans.add(event)
        self._scan_of[event.message] = event
        taken = self._execution.taken_lately(event.message)
        if taken is not None:
            self._scans_seen.add((taken, event))

    def _command_given(self, event: ev.CommandGiven) -> None:
        self._marks.add(Mark(event.t, "command", event.text))

    def _line_given(self, event: ev.LineGiven) -> None:
        self._shell.add(event)
        self._marks.add(Mark(event.t, "command", event.text))

    def _line_completed(self, event: ev.LineCompleted) -> None:
        self.completed = event

    def _noticed(self, event: ev.Notice) -> None:
        self._notices.add(event)
        self._marks.add(Mark(event.t, "notice", event.text))

    def _events_lost(self, event: ev.EventsLost) -> None:
        self.lost = max(self.lost, event.count)
        self._execution.doubt()

    def _contents_lost(self, event: ev.ContentsLost) -> None:
        self.contents_lost = max(self.contents_lost, event.count)

    def _holders(self, group: GroupId, at: Nanoseconds) -> tuple[EntityId, ...]:
        members = self._cast.members(group)
        return tuple(entity.id for entity in members if self._execution.holds(entity.id, at))

    def _events_beside(self, entity: EntityId, at: Nanoseconds, step: int) -> Iterator[Nanoseconds]:
        yield from self._execution.beside(entity, at, step)
        yield from self._waiting.beside(entity, at, step)
        loss = self._queues[entity].loss_beside(at, step)
        if loss is not None:
            yield loss


def _pass_over(_: object) -> None:
    """Nothing is asked of such events yet but that they happened, which ``end`` tells."""
