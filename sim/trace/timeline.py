"""The timeline: a database of a run, filled with events and queried by time."""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence

from sim.trace import events as ev
from sim.trace.ending import UntilEnding
from sim.trace.events import AnyEvent, EntityId, ExecutorId, GroupId, MessageId, ProcessId, ThreadId
from sim.trace.lazy import LazyMapping
from sim.trace.makings import Making
from sim.trace.model import (
    WAITING,
    AxisMark,
    Blocked,
    Call,
    Deed,
    EntityInfo,
    ExecutorInfo,
    Frame,
    GroupInfo,
    Moment,
    Nanoseconds,
    Position,
    Publication,
    Queue,
    Sending,
    Span,
    ThreadInfo,
    Wait,
    Window,
)
from sim.trace.run_stores import RunStores, ShellEvent

__all__ = ["ShellEvent", "Timeline"]

NOBODY: EntityId = 0
"""Code outside callbacks, such as a main thread that calls a service."""


class Timeline:
    """Everything that is known of a run so far; queries by time take O(log n).

    Times are nanoseconds since the run began. The state at ``at`` is that after all events at or before
    ``at``: a call that took no time is running at no moment, but has a span. Windows include their start and
    exclude their end. Queries for unknown ids return empty answers.

    Events may arrive slightly late: answers stay in order of time. Not thread-safe: one owner (the UI thread,
    or the command line's main thread) adds and queries.
    """

    def __init__(self, *, until_ending: bool = False) -> None:
        """``until_ending`` drops events after the request to end the program."""
        run = self._run = RunStores()
        self._cut: Callable[[Iterable[AnyEvent]], Iterable[AnyEvent]] = (
            UntilEnding().cut if until_ending else iter
        )
        self.threads: dict[ThreadId, ThreadInfo] = run.participants.threads
        """The threads, in order of appearance."""
        self.processes: dict[ProcessId, str] = run.participants.processes
        """The names of the programs, in a run of several."""
        self.processes_ended: dict[ProcessId, Nanoseconds] = run.participants.ended
        """When programs ended, in a run of several."""
        self.executors: dict[ExecutorId, ExecutorInfo] = run.participants.executors
        """The executors, in order of appearance."""
        self.nodes, self.ran_on = run.participants.nodes, run.participants.ran_on
        """The names of the nodes, in order of appearance, and on which thread each ran a callback last."""
        self.groups: dict[GroupId, GroupInfo] = run.participants.groups
        """The callback groups, in order of appearance, which is the order of their letters."""
        self.entities: dict[EntityId, EntityInfo] = run.participants.entities
        """The entities, in order of appearance, including destroyed ones."""
        self.makings: Mapping[Making, Mapping[EntityId, Nanoseconds]] = run.makings.kept
        """The entities that callbacks made at each line, and when; without lines of which one is gone."""
        self.services_called: Collection[str] = run.calls.services
        """The services that were called, in order of their first calls."""
        self.given: Sequence[ev.CommandGiven] = run.given
        """The calls of services and resets by the person, in order; ``ros2`` lines are not among them."""
        self.logs: Sequence[ev.Logged | ev.Printed] = run.logs
        """Log lines and printed lines, in order."""
        self.shell: Sequence[ShellEvent] = run.shell
        """The ``ros2`` lines with their output and ends, text typed for programs and printed meanwhile."""
        self.notices: Sequence[ev.Notice] = run.notices
        """The engine's notices, in order."""
        self.choices, self.stalls = run.choices, run.stalls
        """The choices among threads of a schedule that is played, and where a machine stalls, in order."""
        self.conflicts: Sequence[ev.AccessesConflicted] = run.conflicts
        """The accesses to shared data that nothing kept apart, in order."""
        self.mismatches, self.unmatched = run.mismatches, run.unmatched
        """The incompatible publishers and subscriptions, in order, and the first of each subscription."""
        self.synchronisers: Mapping[tuple[str, int], ev.SynchroniserJudged] = run.synchronisers
        """The latest judgement of each synchroniser that had to be judged, by where it is made."""
        self.times_kept: Mapping[ev.NodeId, ev.TimesKept] = run.times_kept
        """The latest times that each node kept over a jump of its clock."""
        self.spin_clashes: Sequence[ev.SpinClashed] = run.spin_clashes
        """The attempts to spin what was already being spun, in order."""
        self.surfaced: Sequence[ev.ExceptionSurfaced] = run.surfaced
        """The exceptions of callbacks that pools raised out of ``spin()``, in order."""
        self.own_threads_at: Callable[[Nanoseconds], list[ev.OwnThreadAt]] = run.own_threads_at
        """Where threads that programs have started wait at a moment, outside callbacks."""
        self.has_nested: Callable[[ThreadId], bool] = run.execution.has_nested
        """Whether a callback on a thread ever ran inside another one."""
        self.scan_seen: Callable[[Nanoseconds], ev.Scanned | None] = run.scans.taken
        """The latest scan that a callback had taken at a moment."""

    def program_at(self, at: Nanoseconds) -> ev.ProgramAt | None:
        """Where the only program is at ``at`` outside callbacks, None if it spins, or is unknown."""
        return next((each for each in self.programs_at(at) if not each.process), None)

    def programs_at(self, at: Nanoseconds) -> list[ev.ProgramAt]:
        """Where programs are at ``at`` outside callbacks, but for those that spin or have ended."""
        latest = (each.latest(at) for each in self._run.program_positions.values())
        found = (each for each in latest if each is not None and each.frames)
        return [each for each in found if self.processes_ended.get(each.process, at) >= at]

    def program_waits_on(self, thread: ThreadId, window: Window) -> Sequence[Position]:
        """Where the program itself waited on its main thread before anything spun, in order of start.

        No callback is there: ``entity`` is 0. A wait in ``Client.call`` is left out: ``blocks_on`` has it.
        """
        known = self.threads.get(thread)
        if known is None or known.name != "MainThread":
            return ()
        every, found = self._run.program_positions[0], list[Position]()
        for place in range(max(0, every.until(window.start) - 1), every.before(window.end)):
            at, following = every[place], every[place + 1 : place + 2]
            if not at.frames or at.doing not in WAITING or at.call == "Client.call":
                continue
            end = following[0].t if following else None
            called = self.spans_on(thread, Window(at.t, end or self.end + 1))[:1]
            end = called[0].start if called else end
            if end is None or end > window.start:
                frames = tuple(Frame(*each) for each in at.frames)
                found.append(
                    Position(at.t, end, thread, NOBODY, at.doing, at.call, frames, at.loop, until=at.until)
                )
        return found

    def extend(self, events: Iterable[AnyEvent]) -> None:
        """Add a batch of events; the size of batches makes no difference."""
        self._run.moment = None
        self._run.extend(self._cut(events))

    @property
    def spill_failure(self) -> str:
        """Why the temporary file cannot be written, so that memory grows with the run; empty if it can."""
        return self._run.spill.failure

    # the run as a whole

    @property
    def started(self) -> ev.RunStarted | None:
        """The run's first event; None until it is known."""
        return self._run.started

    @property
    def begun(self) -> Nanoseconds:
        """Where the trace begins: later than 0 if it was begun during the run."""
        return 0 if self.started is None else self.started.known_from

    @property
    def is_real(self) -> bool:
        """Whether the run is on the real clock."""
        return self.started is not None and self.started.clock != "virtual"

    @property
    def ended(self) -> ev.RunEnded | None:
        """The run's last event; None while it lasts."""
        return self._run.ended

    @property
    def arena(self) -> ev.ArenaShown | None:
        """The robot's arena; None for a run without a robot."""
        return self._run.arena

    @property
    def completed(self) -> ev.LineCompleted | None:
        """The latest answer to a completion request of the prompt."""
        return self._run.completed

    @property
    def lost(self) -> int:
        """The number of events that were dropped."""
        return self._run.lost

    @property
    def contents_lost(self) -> int:
        """The number of published messages whose contents were dropped."""
        return self._run.contents_lost

    @property
    def end(self) -> Nanoseconds:
        """Time of the latest event, 0 for an empty timeline."""
        return self._run.end

    def group_members(self, group: GroupId) -> tuple[EntityInfo, ...]:
        """The entities of a group."""
        return self._run.participants.members(group)

    # intervals

    def spans_on(self, thread: ThreadId, window: Window) -> Sequence[Span]:
        """Calls of a thread, in order of start; a nested call follows the one around it."""
        return self._run.execution.on(thread, window)

    def spans_of(self, entity: EntityId, window: Window) -> Sequence[Span]:
        """Calls of an entity, in order of start; a suspended call is several spans."""
        return self._run.execution.of(entity, window)

    def spans_in(self, group: GroupId, window: Window) -> Sequence[Span]:
        """Calls of a group's entities, in order of start."""
        return self._run.execution.inside(group, window)

    def waits_of(self, entity: EntityId, window: Window) -> Sequence[Wait]:
        """Waits of an entity, in order of start."""
        return self._run.waiting.of(entity, window)

    def blocks_on(self, thread: ThreadId, window: Window) -> Sequence[Blocked]:
        """Intervals in which ``Client.call`` blocked a thread, in order of start."""
        return self._run.blocking.on(thread, window)

    def positions_of(self, entity: EntityId, window: Window) -> Sequence[Position]:
        """Where an entity's callback was in its code, in order of start."""
        return self._run.positions.of(entity, window)

    def positions_on(self, thread: ThreadId, window: Window) -> Sequence[Position]:
        """Where the callbacks on a thread were in their code, in order of start."""
        return self._run.positions.on(thread, window)

    def has_positions(self, thread: ThreadId) -> bool:
        """Whether it is known of any callback on a thread where it was in its code."""
        return thread in self._run.positions.threads

    def position_on(self, thread: ThreadId, at: Nanoseconds) -> Position | None:
        """Where the callback on a thread is at ``at``; None if that is unknown or none runs."""
        return self._run.positions.at(thread, at)

    def drops_of(self, entity: EntityId, window: Window) -> int:
        """The number of messages that an entity's queue lost in the window."""
        return self._run.queues[entity].lost_in(window)

    def losses_of(self, entity: EntityId, window: Window) -> Sequence[Nanoseconds]:
        """The times at which an entity's queue lost messages in the window."""
        return self._run.queues[entity].losses(window)

    @property
    def ever_suspended(self) -> Collection[EntityId]:
        """The entities of which a call was ever suspended in an await."""
        return self._run.execution.ever_suspended()

    def calls_of(self, entity: EntityId, window: Window) -> int:
        """The number of an entity's calls that started in the window; a resumption starts none."""
        return self._run.execution.calls(entity, window)

    def calls_begun(self, entity: EntityId, window: Window) -> Sequence[Span]:
        """The first spans of those calls, in order of start: up to the end or the first suspension."""
        return self._run.execution.begun(entity, window)

    def suspensions_in(self, group: GroupId, window: Window) -> Sequence[tuple[EntityId, Window]]:
        """The stretches in which a callback of a group awaits something, and keeps the group."""
        return [
            (entity, Window(each.start, min(each.end, self._run.end)))
            for entity in self._run.execution.ever_suspended()
            if entity in self.entities and self.entities[entity].group == group
            for each in self._run.execution.suspended(entity, window)
        ]

    def suspended(self, entity: EntityId, window: Window) -> Sequence[Window]:
        """The stretches in which calls of an entity await something; one that lasts has no end."""
        return self._run.execution.suspended(entity, window)

    def busy(self, thread: ThreadId, window: Window) -> float:
        """Share of the window, 0 to 1, in which the thread ran callbacks; idle after the run's end."""
        if window.length <= 0:
            return 0.0
        known = Window(window.start, min(window.end, self._run.end))
        return self._run.execution.busy(thread, known) / window.length

    # moments

    def moment(self, at: Nanoseconds) -> Moment:
        """The state of the run at ``at``; the moment asked for last is cached until new events come."""
        if self._run.moment is None or self._run.moment.at != at:
            self._run.moment = self._moment_at(at)
        return self._run.moment

    def active_since(self, at: Nanoseconds) -> set[EntityId]:
        """The entities that were active at ``at`` or later, or have a call or wait in progress at the end."""
        lasting = {*self._run.waiting.waiting(self.end), *self._run.execution.holders(self.end)}
        return lasting.union(self._run.active.since(at)) & self.entities.keys()

    def queue(self, entity: EntityId, at: Nanoseconds) -> Queue:
        """The queue of an entity; a request's origin is its sending, a reply's its arrival."""
        return self._run.queue(entity, at)

    def dropped(self, at: Nanoseconds) -> int:
        """The number of messages that all queues have lost by ``at``."""
        return self._run.dropped_at.until(at)

    def publication(self, message: MessageId) -> Publication | None:
        """The publication of a message; None if it is unknown."""
        return self._run.publications.of(message)

    def decisions(self, window: Window) -> Iterator[tuple[Deed, Span | Blocked | EntityId]]:
        """What was done with calls, and which entities lost something, in the order of the trace."""
        return self._run.decided(window)

    def neighbour(self, at: Nanoseconds, step: int, losses: bool = True) -> Nanoseconds | None:
        """Time of the next (``step`` > 0) or previous event: never ``at`` itself.

        Events are starts, ends, suspensions and resumptions of callbacks, starts of waits, starts and ends of
        blocking in ``Client.call``, and, if asked for, losses. None if there is none on that side.
        """
        every = (*self.entities, NOBODY)
        times = [time for each in every for time in self._events_beside(each, at, step)]
        lost = [self._run.queues[each].loss_beside(at, step) for each in every if losses]
        times += [time for time in lost if time is not None]
        return min(times, default=None) if step > 0 else max(times, default=None)

    def cancel_since(self, timer: EntityId, since: Nanoseconds, at: Nanoseconds) -> ev.TraceEvent | None:
        """The latest cancellation of a timer, or reset of a cancelled one, between two moments inclusive."""
        latest = self._run.cancels[timer].latest(at)
        return latest if latest is not None and latest.t >= since else None

    @property
    def names_sent(self) -> Collection[str]:
        """The topics and services on which something was sent, in order of the first messages."""
        return self._run.sendings.names

    def sent_on(self, name: str) -> Sequence[Sending]:
        """The messages of a topic, or the requests of a service, in order."""
        return self._run.sendings.on(name, self._run.execution.span)

    # calls, texts and the robot

    @property
    def calls(self) -> Sequence[Call]:
        """The service calls, in order of sending."""
        return self._run.calls.sent()

    def calls_within(self, window: Window) -> Sequence[Call]:
        """The service calls that were pending at some time in the window, in order of sending."""
        return self._run.calls.within(window)

    def asked(self, at: Nanoseconds) -> ev.KeyboardAsked | None:
        """The prompt for the keyboard that is open at ``at``; None if there is none."""
        asked = self._run.asked.latest(at)
        return None if asked is None or asked.reads is ev.Reading.NOTHING else asked

    def logs_until(self, at: Nanoseconds) -> int:
        """The number of ``logs`` written by ``at``."""
        return self._run.logs.until(at)

    def marks(self, window: Window) -> Sequence[AxisMark]:
        """Commands, calls, replies, notices and errors in the window."""
        return self._run.marks.within(window)

    def robot(self, at: Nanoseconds) -> ev.RobotMoved | None:
        """The robot's latest pose at or before ``at``."""
        return self._run.robot.latest(at)

    def command(self, at: Nanoseconds) -> ev.VelocityCommanded | None:
        """The latest velocity command at or before ``at``."""
        return self._run.velocities.latest(at)

    def commands(self, window: Window) -> Sequence[ev.VelocityCommanded]:
        """The velocity commands in the window."""
        return self._run.velocities.within(window)

    def trail(self, window: Window) -> Sequence[ev.RobotMoved]:
        """The robot's poses in the window."""
        return self._run.robot.within(window)

    def scan(self, at: Nanoseconds) -> ev.Scanned | None:
        """The latest scan at or before ``at``."""
        return self._run.scans.latest(at)

    def _moment_at(self, at: Nanoseconds) -> Moment:
        running = {thread: self._run.execution.innermost(thread, at) for thread in self.threads}
        waiting = {entity: self._run.waiting.at(entity, at) for entity in self._run.waiting.waiting(at)}
        return Moment(
            at,
            {thread: span for thread, span in running.items() if span is not None},
            {each: wait for each, wait in waiting.items() if wait is not None and each in self.entities},
            {blocked.thread: blocked for blocked in self._run.blocking.at(at)},
            LazyMapping(self.entities, lambda entity: self.queue(entity, at)),
            self._holders(at),
            self._run.calls.pending(at),
        )

    def _holders(self, at: Nanoseconds) -> dict[GroupId, tuple[EntityId, ...]]:
        holders: dict[GroupId, tuple[EntityId, ...]] = dict.fromkeys(self.groups, ())
        for entity in sorted(self._run.execution.holders(at)):
            known = self.entities.get(entity)
            if known is not None and known.group in holders:
                holders[known.group] += (entity,)
        return holders

    def _events_beside(self, entity: EntityId, at: Nanoseconds, step: int) -> Iterator[Nanoseconds]:
        yield from self._run.execution.beside(entity, at, step)
        yield from self._run.waiting.beside(entity, at, step)
        yield from self._run.blocking.beside(entity, at, step)
