"""How many messages queues lost, as far as that can be known.

Real ROS 2 does not say what its queues lose. A message that is sent and never taken was lost, or
was sent before discovery had connected its two ends: then no loss is told.
"""

from bisect import bisect_right

from sim.trace.events import EntityKind
from sim.trace.model import EntityInfo, Nanoseconds, Window
from sim.trace.timeline import Timeline


def losses(timeline: Timeline, entity: EntityInfo, window: Window) -> int | None:
    """The messages that an entity's queue lost in the window; None for none known of, but some missing."""
    lost = timeline.drops_of(entity.id, window)
    return None if not lost and _misses_some(timeline, entity, window.end) else lost


def all_losses(timeline: Timeline, at: Nanoseconds) -> int | None:
    """The messages that all queues have lost by ``at``; None for none that are known, on real ROS 2."""
    return timeline.dropped(at) or (None if _is_on_ros2(timeline) else 0)


def _misses_some(timeline: Timeline, entity: EntityInfo, end: Nanoseconds) -> bool:
    """Whether messages of its topic are neither taken nor waiting; the latest may be on their way."""
    if entity.kind is not EntityKind.SUBSCRIPTION or not _is_on_ros2(timeline):
        return False
    until = Window(0, end)
    spans = timeline.spans_of(entity.id, until)
    sent = timeline.sent_on(entity.name)
    if not spans:
        return len(sent) > timeline.queue(entity.id, end).depth
    last = timeline.publication(spans[-1].message)
    return last is not None and bisect_right(sent, last.at, key=lambda each: each.at) > timeline.calls_of(
        entity.id, until
    )


def _is_on_ros2(timeline: Timeline) -> bool:
    return timeline.is_real and timeline.started is not None and not timeline.started.distro
