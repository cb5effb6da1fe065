"""The stores of a run: what its events add up to, and what a timeline queries."""

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from operator import attrgetter
from typing import Any, TypeAlias

from sim.trace import events as ev
from sim.trace.activity import Activity
from sim.trace.blocking import Blocking
from sim.trace.decisions import Decisions
from sim.trace.events import AnyEvent, EntityId, EntityKind
from sim.trace.execution import Execution
from sim.trace.makings import Makings
from sim.trace.model import AxisMark, AxisMarkKind, Blocked, Deed, Moment, Nanoseconds, Queue, Span, Window
from sim.trace.participants import Participants
from sim.trace.positions import Positions
from sim.trace.publications import Publications
from sim.trace.queues import OriginTime, QueueHistory
from sim.trace.scans import Scans
from sim.trace.sendings import Sendings
from sim.trace.service_calls import ServiceCalls
from sim.trace.storage.history import History
from sim.trace.storage.spill_file import SpillFile
from sim.trace.storage.table import IntegerTable
from sim.trace.waiting import Waiting

_LINES_BEFORE_PROMPT = 60
"""The latest log lines that may belong to the first prompt for the keyboard."""

ShellEvent: TypeAlias = ev.LineGiven | ev.LineSaid | ev.LineEnded | ev.KeyboardAsked | ev.Typed | ev.Printed


class RunStores:
    """The stores of a run, one for each kind of data; ``end`` is the time of the latest event.

    Events may arrive slightly late: the stores stay in order of time. Older data is kept in one temporary
    file, so that memory does not grow with the run.
    """

    def __init__(self) -> None:
        self.spill = spill = SpillFile()
        self.started: ev.RunStarted | None = None
        self.ended: ev.RunEnded | None = None
        self.arena: ev.ArenaShown | None = None
        self.completed: ev.LineCompleted | None = None
        self.lost = 0
        self.contents_lost = 0
        self.end: Nanoseconds = 0
        self.moment: Moment | None = None
        self.participants = Participants()
        self.makings = Makings()
        self.active = Activity()
        self.decisions = Decisions(spill)
        self.execution = Execution(spill, self.decisions)
        self.waiting = Waiting(spill)
        self.blocking = Blocking(spill, self.decisions)
        self.positions = Positions(spill)
        self.queues: defaultdict[EntityId, QueueHistory] = defaultdict(lambda: QueueHistory(spill))
        self.dropped_at = IntegerTable(spill, 1)
        self.cancels: defaultdict[EntityId, History[ev.TimerCancelled | ev.TimerReset]] = defaultdict(
            lambda: History(attrgetter("t"), ev.TimerCancelled | ev.TimerReset, spill)
        )
        self.publications = Publications(spill)
        self.calls = ServiceCalls(spill)
        self.sendings = Sendings(spill)
        self.marks: History[AxisMark] = History(attrgetter("at"), AxisMark, spill)
        self.given: History[ev.CommandGiven] = History(attrgetter("t"), ev.CommandGiven, spill)
        self.logs: History[ev.Logged | ev.Printed] = History(attrgetter("t"), ev.Logged | ev.Printed, spill)
        self.asked: History[ev.KeyboardAsked] = History(attrgetter("t"), ev.KeyboardAsked, spill)
        self.shell: History[ShellEvent] = History(attrgetter("t"), ShellEvent, spill)
        self.notices: History[ev.Notice] = History(attrgetter("t"), ev.Notice, spill)
        self.mismatches: History[ev.QosMismatched] = History(attrgetter("t"), ev.QosMismatched, spill)
        self.unmatched: dict[EntityId, ev.QosMismatched] = {}
        self.synchronisers: dict[tuple[str, int], ev.SynchroniserJudged] = {}
        self.times_kept: dict[ev.NodeId, ev.TimesKept] = {}
        self.spin_clashes: History[ev.SpinClashed] = History(attrgetter("t"), ev.SpinClashed, spill)
        self.surfaced: History[ev.ExceptionSurfaced] = History(attrgetter("t"), ev.ExceptionSurfaced, spill)
        self.program_positions: defaultdict[ev.ProcessId, History[ev.ProgramAt]] = defaultdict(
            lambda: History(attrgetter("t"), ev.ProgramAt, spill)
        )
        self.own_threads: defaultdict[int, History[ev.OwnThreadAt]] = defaultdict(
            lambda: History(attrgetter("t"), ev.OwnThreadAt, spill)
        )
        self.robot: History[ev.RobotMoved] = History(attrgetter("t"), ev.RobotMoved, spill)
        self.velocities: History[ev.VelocityCommanded] = History(attrgetter("t"), ev.VelocityCommanded, spill)
        self.scans = Scans(spill)
        self.choices: list[ev.ThreadChosen] = []
        self.stalls: list[ev.MachineStalled] = []
        self.conflicts: list[ev.AccessesConflicted] = []
        self._handlers: dict[type, Callable[[Any], object]] = self._make_handlers()

    def extend(self, events: Iterable[AnyEvent]) -> None:
        """Add a batch of events; the size of batches makes no difference."""
        handlers = self._handlers
        end = self.end
        for event in events:
            handle = handlers.get(event.__class__)
            if handle is not None:
                handle(event)
            end = max(end, event.t)
        self.end = end

    def queue(self, entity: EntityId, at: Nanoseconds) -> Queue:
        """The queue of an entity."""
        return self.queues[entity].queue(at, self._origin_time(entity))

    def own_threads_at(self, at: Nanoseconds) -> list[ev.OwnThreadAt]:
        """Where threads that programs have started wait, outside callbacks."""
        latest = (each.latest(at) for each in self.own_threads.values())
        return [each for each in latest if each is not None and each.frames]

    def decided(self, window: Window) -> Iterator[tuple[Deed, Span | Blocked | EntityId]]:
        """The decisions of a window with their calls, ``Blocked``, or the entities that lost something."""
        for deed, number in self.decisions.within(window):
            match deed:
                case Deed.LOST:
                    yield deed, number
                case Deed.BLOCKED | Deed.UNBLOCKED:
                    yield deed, self.blocking.blocked(number)
                case _:
                    yield deed, self.execution.span(number)

    def _origin_time(self, entity: EntityId) -> OriginTime:
        """The origin times of what an entity's queue holds; messages and calls are numbered separately."""
        if self._takes_messages(entity):
            return self.publications.time_of
        if self.participants.entities[entity].kind is EntityKind.SERVICE:
            return self.calls.sent_at
        return _unknown

    def _takes_messages(self, entity: EntityId) -> bool:
        known = self.participants.entities.get(entity)
        return known is None or known.kind is EntityKind.SUBSCRIPTION

    def _make_handlers(self) -> dict[type, Callable[[Any], object]]:
        return {
            ev.RunStarted: partial(setattr, self, "started"),
            ev.RunEnded: partial(setattr, self, "ended"),
            ev.ProcessAppeared: self.participants.add_process,
            ev.ProcessEnded: self.participants.end_process,
            ev.ThreadAppeared: self.participants.add_thread,
            ev.ExecutorAppeared: self._executor_appeared,
            ev.NodeAppeared: self.participants.add_node,
            ev.GroupAppeared: self.participants.add_group,
            ev.EntityAppeared: self._entity_appeared,
            ev.EntityGone: self._entity_gone,
            ev.EntityReady: self._ready,
            ev.TimerCancelled: self._timer_cancelled,
            ev.TimerReset: self._timer_reset,
            ev.MessageDropped: self._message_dropped,
            ev.WaitStarted: self.waiting.start,
            ev.WaitEnded: self._wait_ended,
            ev.CallbackStarted: self._callback_started,
            ev.CallbackEnded: self._callback_ended,
            ev.CallbackAt: self._callback_at,
            ev.CallbackSuspended: self._callback_suspended,
            ev.CallbackResumed: self._callback_resumed,
            ev.SpinClashed: self.spin_clashes.add,
            ev.TimesKept: self._times_kept,
            ev.ProgramAt: lambda event: self.program_positions[event.process].add(event),
            ev.OwnThreadAt: lambda event: self.own_threads[event.number].add(event),
            ev.CallbackFailed: self._callback_failed,
            ev.ExceptionSurfaced: self.surfaced.add,
            ev.Published: self._published,
            ev.QosMismatched: self._qos_mismatched,
            ev.SynchroniserJudged: self._judged,
            ev.ServiceCalled: self._service_called,
            ev.ServiceReplied: self._service_replied,
            ev.RequestLost: self.calls.lose,
            ev.CallBlocked: self.blocking.start,
            ev.CallUnblocked: self.blocking.finish,
            ev.Logged: self.logs.add,
            ev.ThreadChosen: self.choices.append,
            ev.MachineStalled: self.stalls.append,
            ev.AccessesConflicted: self.conflicts.append,
            ev.Printed: self._printed,
            ev.ArenaShown: lambda event: setattr(self, "arena", event if event.robot_radius else None),
            ev.RobotMoved: self.robot.add,
            ev.Scanned: self._scanned,
            ev.VelocityCommanded: self.velocities.add,
            ev.CommandGiven: self._command_given,
            ev.KeyboardAsked: self._keyboard_asked,
            ev.Typed: self.shell.add,
            ev.LineGiven: self._line_given,
            ev.LineSaid: self.shell.add,
            ev.LineEnded: self.shell.add,
            ev.LineCompleted: partial(setattr, self, "completed"),
            ev.Notice: self._noticed,
            ev.EventsLost: self._events_lost,
            ev.ContentsLost: self._contents_lost,
        }

    def _entity_appeared(self, event: ev.EntityAppeared) -> None:
        entity = self.participants.add_entity(event)
        self.execution.join(event.entity, event.group)
        self.makings.note(entity, self.execution.innermost_now(), self.participants.entities)

    def _entity_gone(self, event: ev.EntityGone) -> None:
        self.waiting.finish(event.entity, event.t)
        self.queues[event.entity].clear(event.t)
        self.active.note(event.entity, event.t)
        self.makings.release(event.entity)

    def _timer_cancelled(self, event: ev.TimerCancelled) -> None:
        self.cancels[event.entity].add(event)
        self.makings.release(event.entity)

    def _timer_reset(self, event: ev.TimerReset) -> None:
        self.cancels[event.entity].add(event)

    def _ready(self, event: ev.EntityReady) -> None:
        self.queues[event.entity].arrive(event.t, event.depth, event.message)
        self.active.note(event.entity, event.t)

    def _message_dropped(self, event: ev.MessageDropped) -> None:
        self.queues[event.entity].lose(event.t, event.depth, event.message)
        self.dropped_at.add([event.t])
        self.decisions.add(event.t, Deed.LOST, event.entity)
        self.active.note(event.entity, event.t)

    def _wait_ended(self, event: ev.WaitEnded) -> None:
        self.waiting.finish(event.entity, event.t)
        self.active.note(event.entity, event.t)

    def _executor_appeared(self, event: ev.ExecutorAppeared) -> None:
        self.participants.add_executor(event, is_nested=self.execution.is_running)

    def _callback_started(self, event: ev.CallbackStarted) -> None:
        self.active.note(event.entity, event.t)
        self.execution.start(event)
        self.participants.note_call(event.entity, event.thread)
        self.blocking.go_on(event.thread, event.t)
        self.queues[event.entity].take(event.t, event.depth, event.message)
        if self.scans.carried_by(event.message) and self._takes_messages(event.entity):
            self.scans.take(event.t, event.message)

    def _callback_ended(self, event: ev.CallbackEnded) -> None:
        if self.execution.finish(event):
            self.positions.resume(event.entity, event.t)
        self.positions.finish(event.thread, event.t)
        self.active.note(event.entity, event.t)

    def _callback_at(self, event: ev.CallbackAt) -> None:
        self.positions.start(event, self.execution.innermost(event.thread, event.t))

    def _callback_suspended(self, event: ev.CallbackSuspended) -> None:
        self.execution.suspend(event)
        self.positions.finish(event.thread, event.t)
        self.positions.suspend(event)
        self.active.note(event.entity, event.t)

    def _callback_resumed(self, event: ev.CallbackResumed) -> None:
        self.execution.resume(event)
        self.positions.resume(event.entity, event.t)
        self.active.note(event.entity, event.t)

    def _callback_failed(self, event: ev.CallbackFailed) -> None:
        self.execution.fail(event)
        entity = self.participants.entities.get(event.entity)
        who = entity.spoken_name if entity else "a callback"
        self.marks.add(AxisMark(event.t, AxisMarkKind.ERROR, f"{who} raised {event.error}"))

    def _qos_mismatched(self, event: ev.QosMismatched) -> None:
        self.mismatches.add(event)
        self.unmatched.setdefault(event.entity, event)

    def _published(self, event: ev.Published) -> None:
        self.publications.add(event)
        self.sendings.add(event.topic, event.t, event.message, self._sender(event.entity))

    def _sender(self, entity: EntityId) -> int | None:
        return self.execution.running(entity) if entity else None

    def _service_called(self, event: ev.ServiceCalled) -> None:
        self.calls.send(event)
        self.sendings.add(event.service, event.t, event.call, self._sender(event.entity))
        self.marks.add(AxisMark(event.t, AxisMarkKind.CALL, f"{event.service} {event.request}"))

    def _service_replied(self, event: ev.ServiceReplied) -> None:
        self.calls.reply(event)
        self.marks.add(AxisMark(event.t, AxisMarkKind.REPLY, f"{event.service} {event.response}"))

    def _scanned(self, event: ev.Scanned) -> None:
        self.scans.add(event)
        taken = self.execution.latest_taker(event.message)
        if taken is not None and self._takes_messages(taken.entity):
            self.scans.take(taken.start, event.message)

    def _command_given(self, event: ev.CommandGiven) -> None:
        self.marks.add(AxisMark(event.t, AxisMarkKind.COMMAND, event.text))
        if event.kind in (ev.CommandKind.CALL, ev.CommandKind.OTHER):
            self.given.add(event)

    def _times_kept(self, event: ev.TimesKept) -> None:
        self.times_kept[event.node] = event

    def _judged(self, event: ev.SynchroniserJudged) -> None:
        self.synchronisers[event.made_at] = event

    def _printed(self, event: ev.Printed) -> None:
        self.logs.add(event)
        if self.asked:
            self.shell.add(event)

    def _keyboard_asked(self, event: ev.KeyboardAsked) -> None:
        """Add a prompt; from the first one on, the shell shows what the program prints."""
        if not self.asked:
            since = self.shell[-1].t if self.shell else 0
            for each in self.logs[-_LINES_BEFORE_PROMPT:]:
                if isinstance(each, ev.Printed) and each.t >= since:
                    self.shell.add(each)
        self.asked.add(event)
        self.shell.add(event)

    def _line_given(self, event: ev.LineGiven) -> None:
        self.shell.add(event)
        self.marks.add(AxisMark(event.t, AxisMarkKind.COMMAND, event.text))

    def _noticed(self, event: ev.Notice) -> None:
        self.notices.add(event)
        self.marks.add(AxisMark(event.t, AxisMarkKind.NOTICE, event.text))

    def _events_lost(self, event: ev.EventsLost) -> None:
        self.lost = max(self.lost, event.count)
        self.execution.mark_uncertain()

    def _contents_lost(self, event: ev.ContentsLost) -> None:
        self.contents_lost = max(self.contents_lost, event.count)


def _unknown(_: object) -> None:
    """No origin time: replies, and an action's messages and calls, count from their arrival."""
