"""The rule on callbacks that wait for a transform which they keep from coming."""

from collections.abc import Iterator
from itertools import islice

from sim.diagnosis.cures import remedy_for_waits
from sim.diagnosis.edits.transforms import ask_for_newest
from sim.diagnosis.rule import Explanation, Finding, Rule, by_edit, line_location
from sim.diagnosis.timeline_view import TimelineView
from sim.diagnosis.words import often, only_thread, thread_of, threads_for, who
from sim.quantities.durations import duration
from sim.quantities.nanoseconds import SECOND
from sim.trace.events import EntityId
from sim.trace.model import Nanoseconds, Position, Window
from sim.trace.timeline import Timeline


class LookupKeepsTransform(Rule):
    """A lookup of tf waits in a callback, and the listener's callback, which would bring it, waits for that.

    tf's wait is a loop of short sleeps on the thread that asked: it runs no callbacks.
    """

    id = "lookup-keeps-transform"
    summary = "a lookup of tf waits on the thread that /tf needs"
    by_culprit = True
    hides = frozenset(
        (
            "group-starvation",
            "no-free-worker",
            "behind-others",
            "overrun-timer",
            "stale-data",
            "groups-change-nothing",
        )
    )
    threshold: Nanoseconds = SECOND // 10

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each lookup that a listener's callback cannot end."""
        listeners = [each for each in view.few_entities if each.file.endswith(LISTENER)]
        for entity in view.entities() if listeners else ():
            for at in view.timeline.positions_of(entity.id, view.window):
                until = at.end_at(view.end)
                if at.call.startswith("Buffer.") and until - at.start >= self.threshold:
                    kept = (each.id for each in listeners if _is_kept(each.id, at, view))
                    for listener in islice(kept, 1):
                        size = until - at.start
                        yield Finding(self, at.start, until, listener, entity.id, at.call, size=size)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        window = Window(found.at, found.until)
        lookups = (each for each in timeline.positions_of(found.culprit, window) if each.call == found.about)
        at = next(lookups)
        place, subject = line_location(at.file, at.line), who(found.culprit, timeline)
        listener, call = who(found.subject, timeline), found.about.rpartition(".")[2]
        kept = "and no thread was free for that"
        if threads_for([found.culprit], found.until, timeline) == 1:
            kept = f"and {subject} kept {only_thread(timeline)} meanwhile"
        room = remedy_for_waits(_kept(found, timeline), found.culprit, window, timeline)
        beside = room.words(timeline)
        return Explanation(
            f"{subject} waited {duration(found.lasted)} in {call}(); only {listener} can bring what it looks "
            f"for, {kept}{often(found.count)}",
            "a lookup with a timeout sleeps on its thread and runs no callbacks, not even the listener's",
            "ask without a timeout for the newest one there is, by Time(); or await lookup_transform_async()"
            f"{f'; to wait there, {beside}' if beside else ''}",
            place,
            remedies=(room, *by_edit(place, "ask for the newest transform there is", ask_for_newest)),
        )


LISTENER = "/tf2_ros/transform_listener.py"
"""The end of the file of a listener's callbacks, the model's and tf2's own."""


def _is_kept(listener: EntityId, at: Position, view: TimelineView) -> bool:
    """Return whether a listener's callback waits for one that is in a lookup, or has no other thread."""
    thread = thread_of(listener, view.end, view.timeline)
    waits = view.timeline.waits_of(listener, Window(at.start, at.end_at(view.end)))
    has_no_other = thread is not None and thread.id == at.thread and not thread.executor
    return has_no_other or any(each.holder == at.entity for each in waits)


def _kept(found: Finding, timeline: Timeline) -> list[EntityId]:
    """Return the callbacks that wait for the lookup's, the listener's among them: one of them may send it."""
    window = Window(found.at, found.until)
    return [
        each
        for each in timeline.entities
        if each != found.culprit
        and any(wait.holder == found.culprit for wait in timeline.waits_of(each, window))
    ]
