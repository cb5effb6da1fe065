"""The status at the right of a lane at the cursor's moment: load, queue, lateness."""

from dataclasses import dataclass

from cbtui.looks.theme import GLYPHS, Charset, Ink, Role, TextRun
from cbtui.text.callback_names import short_name
from cbtui.text.cells import fit
from cbtui.widgets.lanes.rows import (
    GroupLane,
    Lane,
    MemberLane,
    ServiceLane,
    SoleLane,
    ThreadLane,
    ever_ran,
    never_ran,
)
from cbtui.widgets.lanes.service_calls import LatestCalls
from sim.quantities.durations import duration
from sim.trace.descriptions import mismatch_of
from sim.trace.events import EntityKind, GroupKind, TimerCancelled
from sim.trace.figures.waiting import wait_told, waits_for_others
from sim.trace.model import EntityInfo, GroupInfo, Moment, Span, ThreadInfo, Window
from sim.trace.timeline import Timeline

PLAIN = Ink(Role.TEXT)
FAINT = Ink(Role.FAINT)
WARN = Ink(Role.WARN)

_LATE_AT_LEAST = 1_000_000
_QUIET_AT_LEAST = 100_000_000
_WIDE = 22


@dataclass(frozen=True, slots=True)
class LaneStatus:
    """Writes the status of lanes at one moment, in ``width`` columns."""

    timeline: Timeline
    shown: Window
    moment: Moment
    calls: LatestCalls
    charset: Charset
    width: int

    def of(self, lane: Lane, latest: Span | None) -> TextRun:
        """Return the status of a lane; ``latest`` is the last call that it shows before the cursor."""
        match lane:
            case ThreadLane(thread):
                return self._thread(thread)
            case GroupLane(group):
                return self._group(group)
            case MemberLane(entity) | SoleLane(entity):
                return self._entity(entity, latest)
            case ServiceLane(service):
                return TextRun(self.calls.summary(service, self.moment.at), PLAIN)

    def _thread(self, thread: ThreadInfo) -> TextRun:
        past = Window(self.shown.start, min(self.shown.end, self.moment.at))
        share = self.timeline.busy(thread.id, past) if past.length > 0 else 0.0
        running = self.moment.running.get(thread.id)
        if running is not None:
            if self.width < _WIDE:
                return TextRun(f"{share:4.0%} busy", PLAIN)
            name, took = self._caller(running), f" {duration(self.moment.at - running.start)}"
            room = self.width - 1 - len(took) - len("100%  ")
            return TextRun(f"{share:4.0%}  {fit(name, min(len(name), room), self.charset)}{took}", PLAIN)
        if share == 0 and not ever_ran(self.timeline, thread.id, self.moment.at):
            if thread.executor == 0:
                return TextRun("no callbacks" if self.width >= _WIDE else "own thread", FAINT)
            is_never = never_ran(self.timeline, thread.id)
            if self.width >= _WIDE:
                return TextRun(f"  0%  {'never needed' if is_never else 'not used yet'}", FAINT)
            # Of a run that goes on nobody knows whether the thread will be used.
            is_later = self.timeline.ended is not None and not is_never
            return TextRun("  0% not yet" if is_later else "  0% unused", FAINT)
        return TextRun(f"{share:4.0%} busy", PLAIN if share else FAINT)

    def _caller(self, span: Span) -> str:
        entity = self.timeline.entities[span.entity]
        return f"{self.timeline.groups[entity.group].letter} {short_name(entity.spoken_name)}"

    def _group(self, group: GroupInfo) -> TextRun:
        entities = self.timeline.entities
        waits = waits_for_others(self.moment, self.timeline)
        waiting = sum([entities[wait.entity].group == group.id for wait in waits])
        holders = len(self.moment.holders.get(group.id, ()))
        if group.kind is GroupKind.REENTRANT:
            # One callback may run several times at once.
            spans = [span.entity for span in self.moment.running.values()]
            running = sum(entities[entity].group == group.id for entity in spans)
            here = Window(self.moment.at, self.moment.at + 1)
            awaiting = {entity for entity, _ in self.timeline.suspensions_in(group.id, here)}
            awaits = len(awaiting.difference(spans))
            calls = max(holders - awaits, running)
            verb, count = ("run", calls) if calls else ("await", awaits)
            does = f"{count} {verb}{'s' if count == 1 else ''}"
            state = f"{'' if waiting else 'open, '}{does}" if holders or running else "open"
        else:
            state = "held" if holders else "free"
        if waiting:
            return TextRun(f"{state}, {waiting} wait{'s' if waiting == 1 else ''}", WARN)
        return TextRun(state, PLAIN if holders else FAINT)

    def _entity(self, entity: EntityInfo, latest: Span | None) -> TextRun:
        if latest is not None:  # the cursor's column may show a longer call before the last one
            since = Window(latest.start, self.moment.at + 1)
            latest = next(reversed(self.timeline.spans_of(entity.id, since)), latest)
        match entity.kind:
            case EntityKind.TIMER:
                return self._timer(entity, latest)
            case EntityKind.SUBSCRIPTION:
                return self._queue(entity, latest)
            case EntityKind.SERVICE:
                told = self.calls.summary(entity.name, self.moment.at)
                return TextRun(told if len(told) < self.width else told.replace(",", ""), PLAIN)
            case EntityKind.CLIENT:
                return self._client(entity)
            case EntityKind.WAITABLE if entity.name and not entity.callback:
                return TextRun("action", FAINT)
            case _:
                return TextRun("", PLAIN)

    def _timer(self, timer: EntityInfo, latest: Span | None) -> TextRun:
        wait = wait_told(timer.id, self.moment, self.timeline)
        if wait is not None:
            lasted = self.moment.at - wait.since
            return TextRun(f"late {duration(lasted)}" if lasted else "is due", WARN)
        since = 0 if latest is None else latest.start
        if isinstance(self.timeline.cancel_since(timer.id, since, self.moment.at), TimerCancelled):
            return TextRun("cancelled", FAINT)
        if latest is None:
            return TextRun("", PLAIN)
        if is_late(latest, timer):
            return TextRun(f"was late {duration(latest.age)}", WARN)
        quiet = self.moment.at - latest.start
        if latest.end is not None and quiet > max(2 * timer.period, _QUIET_AT_LEAST):
            return TextRun(f"last {duration(quiet)} ago", FAINT)  # as by a clock that stands still
        return TextRun("on time", FAINT)

    def _client(self, client: EntityInfo) -> TextRun:
        """Tell a client from the service of the same name: its queue holds replies."""
        replies = self.timeline.queue(client.id, self.moment.at).depth
        if replies == 0:
            return TextRun("client", FAINT)
        told = f"client, {replies} {'reply' if replies == 1 else 'replies'}"
        return TextRun(told if len(told) < self.width else "client", PLAIN)

    def _queue(self, entity: EntityInfo, latest: Span | None) -> TextRun:
        queue = self.timeline.queue(entity.id, self.moment.at)
        mismatch = mismatch_of(entity, queue, self.timeline, self.moment.at)
        if mismatch and len(mismatch) < self.width:
            return TextRun(mismatch, WARN)
        full = entity.depth and queue.depth >= entity.depth
        level = f"{queue.depth}/{entity.depth}{'!' if full else ''}"
        lost = f" lost {_count(queue.dropped)}" if queue.dropped else ""
        age = "" if latest is None else f" {GLYPHS[self.charset].between} age {duration(latest.age)}"
        brief = f"{level} lost {_count(queue.dropped, 1000)}"
        texts = (f"queue {level}{lost}{age}", f"queue {level}{lost}", f"{level}{lost}", brief, level)
        fitting = (text for text in texts if len(text) < self.width)
        return TextRun(next(fitting, level), WARN if full else PLAIN)


def is_late(span: Span, timer: EntityInfo) -> bool:
    """Tell whether a timer's call came late: by a tenth of its period or more, and by 1 ms at least."""
    return span.age >= max(timer.period // 10, _LATE_AT_LEAST)


def _count(number: int, thousands_from: int = 10_000) -> str:
    return str(number) if number < thousands_from else f"{number // 1000}k"
