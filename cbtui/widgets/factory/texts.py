"""The factory's texts: why something waits, who sits where, and a headline of the scene."""

from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

from cbtui.looks.theme import GLYPHS, Charset
from cbtui.text.callback_names import short_name
from cbtui.widgets.factory.scene import Area, Belt, FactoryScene, FactoryWorker, WorkerState
from cbtui.widgets.lanes.details import time_waited
from cbtui.widgets.lanes.names import short_thread, told_apart
from sim.diagnosis.words import late_reply
from sim.quantities.durations import duration
from sim.quantities.plural import counted
from sim.trace.descriptions import doing_of, name_of
from sim.trace.events import EntityKind, GroupKind, Reason
from sim.trace.figures.waiting import waited_so_far, waits_since
from sim.trace.model import Blocked, EntityInfo, Nanoseconds, Position
from sim.trace.timeline import Timeline

_LATE_AT_LEAST: Nanoseconds = 1_000_000


def first_fitting(texts: Sequence[str], room: int) -> str:
    """Return the first text of at most ``room`` columns; "" if there is none."""
    return next((text for text in texts if len(text) <= room), "")


def counts_text(scene: FactoryScene) -> str:
    """Return the number of workers and areas: ``4 workers, 1 seat``."""
    if not scene.areas:
        return "no callback group yet"
    return f"{counted(len(scene.workers), 'worker')}, {_places(scene)}"


class Headline(NamedTuple):
    """A scene in one sentence: the number of workers and areas, and the trouble."""

    counts: str
    trouble: str = ""

    @property
    def lead(self) -> str:
        """The part before the trouble."""
        return f"{self.counts}: " if self.trouble else self.counts

    @property
    def text(self) -> str:
        """The full sentence."""
        return self.lead + self.trouble


def headlines(scene: FactoryScene) -> tuple[Headline, ...]:
    """Return ways to sum up a scene, from the longest to the shortest."""
    counts = counts_text(scene)
    if not scene.areas:
        return (Headline(counts),)
    trouble, brief = _trouble(scene), _trouble(scene, is_brief=True)
    if not trouble:
        return Headline(f"{counts}, {_calm(scene)}"), Headline(counts)
    idle = [f"{trouble}, {counted(scene.idle, 'worker')} idle"] if scene.idle else []
    return (*(Headline(counts, each) for each in (*idle, trouble, brief)), Headline(counts))


def _places(scene: FactoryScene) -> str:
    areas = scene.areas
    if scene.more:
        return counted(len(areas) + scene.more, "area")
    is_open = sum(area.is_open for area in areas)
    if is_open == len(areas):
        return counted(is_open, "open area")
    if [area.group.kind for area in areas] == [GroupKind.EXCLUSIVE]:
        return "1 seat"
    return counted(len(areas), "area")


def _trouble(scene: FactoryScene, *, is_brief: bool = False) -> str:
    """Say how many callbacks wait for what, but for those whose group is held by their own last call."""
    waits = Counter(wait.reason for wait in scene.waits())
    objects = {
        Reason.GROUP_HELD: f" for {'it' if len(scene.areas) == 1 else 'a seat'}",
        Reason.NO_FREE_WORKER: " for a worker",
        Reason.EVENT_QUEUE: " in the event queue",
        Reason.NOBODY_SPINS: ", nobody spins",
    }
    return ", ".join(
        f"{number if is_brief else counted(number, 'callback')} wait{'s' if number == 1 else ''}{what}"
        for reason, what in objects.items()
        if (number := waits[reason])
    )


def _calm(scene: FactoryScene) -> str:
    """Say what the belts and seats still tell of while no callback waits for another one."""
    stuck = Counter(
        "blocked in a call" if isinstance(worker.blocked, Blocked) else doing_of(worker.blocked)
        for worker in scene.workers
        if worker.blocked is not None
    )
    if stuck:
        return ", ".join(
            f"{counted(number, 'worker')} {does if number == 1 else does.replace('waits', 'wait', 1)}"
            for does, number in stuck.items()
        )
    if own := sum(1 for _ in scene.every_wait()):
        verb = "waits for its own last call" if own == 1 else "wait for their own last calls"
        return f"{counted(own, 'callback')} {verb}"
    return "no callback waits for another"


def wait_texts(belt: Belt, timeline: Timeline, now: Nanoseconds) -> tuple[str, ...]:
    """Return how long a callback has waited and why, from the longest text to the shortest; () if it does not
    wait.

    The last but two only says why, the last two only how long.
    """
    wait = belt.wait
    if wait is None:
        return ()
    lasted = max(0, now - waits_since(wait, belt.queue, timeline))
    took, before = duration(lasted), waited_so_far(wait, timeline.moment(now), timeline)
    verb = "late" if belt.entity.kind is EntityKind.TIMER else "waits"
    told = (f"{verb} {before}", before, f"{verb} {took}", took)
    if verb == "late" and not lasted:
        told = ("is due", "due", "is due", "due")
    full = [f"{told[0]}: {why}" for why in _why(belt, timeline)]
    brief = [f"{told[1]}: {why}" for why in _why(belt, timeline)]
    return (*full[:-1], *brief[:-1], full[-1], brief[-1], _why(belt, timeline)[-1], *told[2:])


def _why(belt: Belt, timeline: Timeline) -> tuple[str, ...]:
    wait = belt.wait
    if wait is None or wait.reason is not Reason.GROUP_HELD:
        return _WITHOUT_HOLDER[wait.reason] if wait else ()
    if wait.holder == belt.entity.id:
        return ("its last call still runs", "last call runs", "own call")
    holder = name_of(wait.holder, timeline)
    return (f"seat held by {holder}", f"seat held by {short_name(holder)}", "seat held", "held")


_WITHOUT_HOLDER = {
    Reason.GROUP_HELD: ("seat held", "held"),
    Reason.NO_FREE_WORKER: ("no free worker", "no worker"),
    Reason.EVENT_QUEUE: (Reason.EVENT_QUEUE.value, "in the event queue", "queued"),
    Reason.NOBODY_SPINS: ("nobody spins",),
}


def belt_name(belt: Belt, timeline: Timeline, charset: Charset) -> str:
    """Return the name of a belt, as on the lanes: a client's has a mark that tells it from its service."""
    return short_name(told_apart(belt.entity, timeline, GLYPHS[charset].back))


def queue_level(belt: Belt) -> str:
    """Return the level of a queue: ``3/10``, ``10/10 !``; the bare number if it has no limit.

    A client's says that it is one, or how many replies wait.
    """
    if belt.entity.kind is EntityKind.CLIENT:
        replies = belt.queue.depth
        return "client" if replies == 0 else f"{replies} {'reply' if replies == 1 else 'replies'}"
    if belt.entity.depth <= 0:
        return str(belt.queue.depth)
    return f"{belt.queue.depth}/{belt.entity.depth}{' !' if belt.full else ''}"


def belt_details(belt: Belt, now: Nanoseconds) -> list[tuple[str, bool]]:
    """Return further facts about a belt, each with whether it is a warning."""
    found = []
    if belt.queue.dropped:
        found.append((f"lost {belt.queue.dropped}", True))
    if belt.tick is not None and belt.wait is None:
        if belt.tick.is_cancelled:
            found.append(("cancelled", False))
        if belt.tick.late >= max(belt.entity.period // 10, _LATE_AT_LEAST):
            found.append((f"was {duration(belt.tick.late)} late", True))
        if belt.tick.due is not None:
            is_due = belt.tick.due <= now
            found.append(("is due" if is_due else f"next in {duration(belt.tick.due - now)}", False))
    return found


def admission_texts(area: Area) -> tuple[str, ...]:
    """Return how many callbacks an area admits, from the longest text to the shortest."""
    match area.group.kind:
        case GroupKind.EXCLUSIVE:
            return ("one seat", "1 seat")
        case GroupKind.REENTRANT:
            return ("open to all", "open")
        case GroupKind.CUSTOM:
            return ("rules of its own", "custom")
        case GroupKind.NONE:
            return ("no group",)


def activity_texts(worker: FactoryWorker, timeline: Timeline) -> tuple[str, ...]:
    """Return where a worker is, in three lengths; the shortest only tells whether it is idle."""
    match worker.stay:
        case WorkerState.NEVER:
            return ("never needed", "unused", "unused")
        case WorkerState.NOT_YET:
            return ("not used yet", "unused", "unused")
        case WorkerState.IDLE:
            return ("waits for work", "waits", "waits")
        case WorkerState.STOPPED:
            return ("spins no more", "stopped", "stopped")
        case _:
            words = _WHERE[WorkerState.WORKS if worker.inside and not worker.begins else worker.stay]
            return (*(f"{word} {_letter(worker, timeline)}" for word in words), "")


_WHERE = {
    WorkerState.COMES: ("goes to", "to"),
    WorkerState.WORKS: ("works in", "in"),
    WorkerState.LEAVES: ("back from", "from"),
}


def _letter(worker: FactoryWorker, timeline: Timeline) -> str:
    entity = timeline.entities.get(worker.span.entity) if worker.span else None
    return "?" if entity is None else timeline.groups[entity.group].letter


def blocked_texts(worker: FactoryWorker, scene: FactoryScene, *, is_brief: bool = False) -> tuple[str, ...]:
    """Return that a worker waits in its call, from the longest text to the shortest; () if not.

    Brief ones do not tell of the reply, or who has the lock.
    """
    blocked = worker.blocked
    if blocked is None:
        return ()
    took = duration(scene.now - blocked.start)
    if isinstance(blocked, Position):
        holder = scene.timeline.threads.get(blocked.holder) if blocked.waits_for_lock else None
        does = doing_of(blocked)
        why = does.removeprefix("waits ")
        who = () if is_brief or holder is None else (f"{does}, {short_thread(holder.name)} has it",)
        return (*who, does, why, why.partition(" ")[2], f"waits {took}", "waits")
    service = blocked.service
    is_there = late_reply(blocked, scene.timeline.moment(scene.now), scene.timeline)
    why = "its reply is there" if is_there else f"no reply for {took}"
    full = (f"blocked in call of {service}, {why}", f"blocked in call of {service} {took}")
    brief = (f"blocked in {service} {took}", f"blocked in call {took}", f"blocked {took}", "blocked")
    return brief if is_brief else (*full, *brief)


def crowd_texts(busy: int, blocked: int) -> tuple[str, ...]:
    """Return how many of those who sit side by side work, and how many wait in a call or for a lock."""
    works = f"{busy} busy" if busy else ""
    if not blocked:
        return (works,)
    waits = f"{blocked} wait{'s' if blocked == 1 else ''}"
    return (f"{works}, {waits}" if works else waits, waits)


def finished_texts(worker: FactoryWorker, callback: str, timeline: Timeline) -> tuple[str, ...]:
    """Return what a worker who has just left a seat did there, from the longest text to the shortest."""
    span = worker.span
    length = 0 if span is None or span.end is None else span.end - span.start
    took = duration(length) if length else "no time"
    waited = time_waited(timeline, span) if span is not None and length else 0
    did = f"waited {duration(waited)}" if 2 * waited > length else f"took {took}"
    ran = "just ran"
    if span is not None and span.error:
        did, ran = f"raised after {took}" if length else "raised at once", "raised"
    return (
        f"{callback} {did}  {worker.name}",
        f"{callback} {did}",
        f"{callback} {ran}",
        f"{short_name(callback)} {ran}",
        f"{short_name(callback)} {ran.removeprefix('just ')}",
        short_name(callback),
    )


def suspended_texts(entity: EntityInfo, *, is_open: bool) -> tuple[str, ...]:
    """Return that a call on no thread awaits, and keeps a seat unless its area is open; longest first."""
    name = entity.spoken_name
    if is_open:
        return (f"{name} awaits, on no thread", f"{name} awaits", f"{short_name(name)} awaits")
    return (f"kept by {name}, which awaits", f"kept by {name}", f"kept: {short_name(name)}")
