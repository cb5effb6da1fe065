"""The timeline: everything that is known of a run, grown event by event and asked by time."""

from collections.abc import Callable, Collection, Iterable, Iterator, Sequence

from sim.trace import events as ev
from sim.trace.ending import UntilEnding
from sim.trace.events import (
    AnyEvent,
    EntityId,
    ExecutorId,
    GroupId,
    MessageId,
    NodeId,
    ProcessId,
    ThreadId,
)
from sim.trace.lazy_mapping import LazyMapping
from sim.trace.model import (
    AxisMark,
    Blocked,
    Call,
    Entity,
    Executor,
    Group,
    Moment,
    Nanoseconds,
    Publication,
    Queue,
    Span,
    Thread,
    Wait,
    Window,
)
from sim.trace.run_stores import RunStores, ShellEvent

__all__ = ["ShellEvent", "Timeline"]

NOBODY: EntityId = 0
"""Stands for code outside of callbacks, such as a main thread that calls a service."""


class Timeline:
    """Everything that is known of a run so far; grows by batches, answers by time in O(log n).

    Times are nanoseconds since the run began. What is asked of a moment ``at`` holds after every event at or
    before ``at``: a call that took no time runs at no moment, and is found by its span. Windows include
    their start and exclude their end. Ids that are not known get empty answers.

    Events may come late by a little: answers stay in order of time. Not thread-safe: one owner (the UI
    thread, or the command line's main thread) extends and asks.
    """

    def __init__(self, *, until_ending: bool = False) -> None:
        """``until_ending`` leaves out what a program does after it was told to end."""
        self._run = RunStores()
        self._counted: Callable[[Iterable[AnyEvent]], Iterable[AnyEvent]] = (
            UntilEnding().cut if until_ending else iter
        )
        self._moment: Moment | None = None

    def extend(self, events: Iterable[AnyEvent]) -> None:
        """Take in a batch; state after batches is the state after one batch of them all."""
        self._moment = None
        self._run.extend(self._counted(events))

    @property
    def spill_failure(self) -> str:
        """Why no more goes to the temporary file, so that memory grows with the run; empty if it does."""
        return self._run.spill.failure

    # the run as a whole

    @property
    def started(self) -> ev.RunStarted | None:
        """How the run began; None until that is known."""
        return self._run.started

    @property
    def ended(self) -> ev.RunEnded | None:
        """How the run ended; None while it lasts."""
        return self._run.ended

    @property
    def arena(self) -> ev.ArenaShown | None:
        """What stands around the robot; None for a run without one."""
        return self._run.arena

    @property
    def completed(self) -> ev.LineCompleted | None:
        """The latest answer to a completion asked for at the prompt."""
        return self._run.completed

    @property
    def lost(self) -> int:
        """How many events the trace has thrown away."""
        return self._run.lost

    @property
    def contents_lost(self) -> int:
        """How many messages were published without their contents being kept."""
        return self._run.contents_lost

    # participants

    @property
    def end(self) -> Nanoseconds:
        """Time of the latest event, 0 for an empty timeline."""
        return self._run.end

    @property
    def threads(self) -> dict[ThreadId, Thread]:
        """The threads, in order of appearance."""
        return self._run.participants.threads

    @property
    def processes_ended(self) -> dict[ProcessId, Nanoseconds]:
        """When programs ended, in a run of several."""
        return self._run.participants.ended

    @property
    def executors(self) -> dict[ExecutorId, Executor]:
        """The executors, in order of appearance."""
        return self._run.participants.executors

    @property
    def nodes(self) -> dict[NodeId, str]:
        """The names of the nodes, in order of appearance."""
        return self._run.participants.nodes

    @property
    def groups(self) -> dict[GroupId, Group]:
        """The callback groups, in order of appearance, which is the order of their letters."""
        return self._run.participants.groups

    @property
    def entities(self) -> dict[EntityId, Entity]:
        """The entities, in order of appearance; those that are gone stay."""
        return self._run.participants.entities

    def group_members(self, group: GroupId) -> tuple[Entity, ...]:
        """The entities of a group."""
        return self._run.participants.members(group)

    # intervals

    def spans_on(self, thread: ThreadId, window: Window) -> Sequence[Span]:
        """What a thread ran, in order of start; a nested call follows the one it is in."""
        return self._run.execution.on(thread, window)

    def spans_of(self, entity: EntityId, window: Window) -> Sequence[Span]:
        """Calls of an entity, in order of start; one that was suspended is several spans."""
        return self._run.execution.of(entity, window)

    def spans_in(self, group: GroupId, window: Window) -> Sequence[Span]:
        """Calls of a group's entities, in order of start."""
        return self._run.execution.inside(group, window)

    def waits_of(self, entity: EntityId, window: Window) -> Sequence[Wait]:
        """Waits of an entity, in order of start."""
        return self._run.waiting.of(entity, window)

    def blocks_on(self, thread: ThreadId, window: Window) -> Sequence[Blocked]:
        """Where a thread stood still in ``Client.call``, in order of start."""
        return self._run.blocking.on(thread, window)

    def drops_of(self, entity: EntityId, window: Window) -> int:
        """How many messages an entity's queue lost in the window."""
        return self._run.queues[entity].lost_in(window)

    def losses_of(self, entity: EntityId, window: Window) -> Sequence[Nanoseconds]:
        """When an entity's queue lost messages in the window."""
        return self._run.queues[entity].losses(window)

    def calls_of(self, entity: EntityId, window: Window) -> int:
        """How many calls of an entity's callback began in the window; going on after a suspension is none."""
        return self._run.execution.calls(entity, window)

    def calls_begun(self, entity: EntityId, window: Window) -> Sequence[Span]:
        """Where those calls begin, in order of start: the whole of each, or what lies before a suspension."""
        return self._run.execution.begun(entity, window)

    def busy(self, thread: ThreadId, window: Window) -> float:
        """Share of the window, 0 to 1, in which the thread ran callbacks; nothing is known past the end."""
        if window.length <= 0:
            return 0.0
        known = Window(window.start, min(window.end, self._run.end))
        return self._run.execution.busy(thread, known) / window.length

    # moments

    def moment(self, at: Nanoseconds) -> Moment:
        """Who runs, waits or stands still, and why; what is held, queued, called and logged by then.

        Every pane asks for the same one: the latest is kept until the run goes on.
        """
        if self._moment is None or self._moment.at != at:
            self._moment = self._moment_at(at)
        return self._moment

    def active_since(self, at: Nanoseconds) -> set[EntityId]:
        """The entities that did anything at ``at`` or later, or are in the middle of something at the end."""
        lasting = {*self._run.waiting.waiting(self.end), *self._run.execution.holders(self.end)}
        return lasting.union(self._run.active.since(at)) & self.entities.keys()

    def queue(self, entity: EntityId, at: Nanoseconds) -> Queue:
        """The queue of an entity: a request in it was born when it was sent, a reply when it arrived."""
        return self._run.queue(entity, at)

    def dropped(self, at: Nanoseconds) -> int:
        """How many messages all queues have lost by ``at``."""
        return self._run.dropped_at.until(at)

    def published_at(self, message: MessageId) -> Nanoseconds | None:
        """When a message was published; None for one that is not known to have been."""
        return self._run.publications.time_of(message)

    def publication(self, message: MessageId) -> Publication | None:
        """How a message was published, and by whom; None for one that is not known to have been."""
        return self._run.publications.of(message)

    def neighbour(self, at: Nanoseconds, entity: EntityId | None, step: int) -> Nanoseconds | None:
        """Time of the next (``step`` > 0) or previous event of an entity, or of any: never ``at`` itself.

        Events are starts and ends of callbacks (and where one is suspended and resumed), starts of waits,
        starts and ends of standing still in ``Client.call``, and drops. None if there is none on that side.
        """
        asked = (*self.entities, NOBODY) if entity is None else (entity,)
        times = (time for each in asked for time in self._events_beside(each, at, step))
        return min(times, default=None) if step > 0 else max(times, default=None)

    # what was said, and the robot

    @property
    def calls(self) -> Sequence[Call]:
        """The service calls, in order of sending."""
        return self._run.calls.sent()

    def calls_within(self, window: Window) -> Sequence[Call]:
        """The service calls that were out at some time in the window, in order of sending."""
        return self._run.calls.within(window)

    @property
    def services_called(self) -> Collection[str]:
        """The services that were called, in order of their first calls."""
        return self._run.calls.services

    @property
    def logs(self) -> Sequence[ev.Logged | ev.Printed]:
        """Log lines and printed lines, in order."""
        return self._run.logs

    @property
    def shell(self) -> Sequence[ShellEvent]:
        """What the shell and the programs' terminal showed, in order.

        These are the ``ros2`` lines that were given, what they wrote and how they ended; what was typed for
        programs that read, and what was printed meanwhile.
        """
        return self._run.shell

    def asked(self, at: Nanoseconds) -> ev.KeyboardAsked | None:
        """How a program waits for the keyboard at ``at``; None if none does."""
        asked = self._run.asked.latest(at)
        return None if asked is None or asked.reads is ev.Reading.NOTHING else asked

    def logs_until(self, at: Nanoseconds) -> int:
        """How many of ``logs`` had been written by ``at``."""
        return self._run.logs.until(at)

    @property
    def notices(self) -> Sequence[ev.Notice]:
        """What the engine had to say, in order."""
        return self._run.notices

    @property
    def mismatches(self) -> Sequence[ev.QosMismatched]:
        """The publishers and subscriptions that do not match, in order."""
        return self._run.mismatches

    @property
    def spin_clashes(self) -> Sequence[ev.SpinClashed]:
        """What asked to spin what was being spun, in order."""
        return self._run.spin_clashes

    def marks(self, window: Window) -> Sequence[AxisMark]:
        """Commands, calls, replies, notices and errors in the window."""
        return self._run.marks.within(window)

    def robot(self, at: Nanoseconds) -> ev.RobotMoved | None:
        """Where the robot was: the latest at or before ``at``."""
        return self._run.robot.latest(at)

    def command(self, at: Nanoseconds) -> ev.VelocityCommanded | None:
        """The velocity command in force: the latest at or before ``at``."""
        return self._run.velocities.latest(at)

    def commands(self, window: Window) -> Sequence[ev.VelocityCommanded]:
        """The velocity commands that the robot got in the window."""
        return self._run.velocities.within(window)

    def trail(self, window: Window) -> Sequence[ev.RobotMoved]:
        """Where the robot was in the window."""
        return self._run.robot.within(window)

    def scan(self, at: Nanoseconds) -> ev.Scanned | None:
        """The latest true scan at or before ``at``."""
        return self._run.scans.latest(at)

    def scan_seen(self, at: Nanoseconds) -> ev.Scanned | None:
        """The scan whose message a callback last took, at or before ``at``."""
        return self._run.scans.seen(at)

    def _moment_at(self, at: Nanoseconds) -> Moment:
        running = {thread: self._run.execution.innermost(thread, at) for thread in self.threads}
        waiting = {entity: self._run.waiting.at(entity, at) for entity in self._run.waiting.waiting(at)}
        return Moment(
            at,
            {thread: span for thread, span in running.items() if span is not None},
            {
                entity: wait
                for entity, wait in waiting.items()
                if wait is not None and entity in self.entities
            },
            {blocked.thread: blocked for blocked in self._run.blocking.at(at)},
            LazyMapping(self.entities, lambda entity: self.queue(entity, at)),
            self._holders(at),
            self._run.calls.pending(at),
            self.logs_until(at),
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
        loss = self._run.queues[entity].loss_beside(at, step)
        if loss is not None:
            yield loss
