"""The rule on synchronisers of ``message_filters`` that hand on nothing of what they get."""

from collections.abc import Iterable, Iterator

from sim.diagnosis.edits.synchronisers import allow_slop, lengthen_queues
from sim.diagnosis.rule import Explanation, Finding, Rule, by_edit, line_location
from sim.diagnosis.timeline_view import TimelineView
from sim.diagnosis.words import listed, who
from sim.quantities.durations import duration
from sim.quantities.nanoseconds import SECOND
from sim.trace.events import EntityKind, SynchroniserJudged
from sim.trace.model import Window
from sim.trace.timeline import Timeline

_SLOPS = ("0.001", "0.002", "0.005", "0.01", "0.02", "0.05", "0.1", "0.2", "0.5", "1.0")
"""What is offered, in seconds: the first that exceeds by half how far most stamps are apart."""


class NeverSynchronised(Rule):
    """A synchroniser of ``message_filters`` gets messages of its topics, and hands on no set of them.

    Source: message_filters, ``TimeSynchronizer.add``: it keeps what has no partner yet, and says nothing.
    """

    id = "never-synchronised"
    summary = "a synchroniser gets messages, and never brings any together"
    known_from_start = True

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each synchroniser that the engine reports, unless it has begun to hand on since."""
        for (file, line), event in view.timeline.synchronisers.items():
            if not event.matched and not _is_heard_or_told(_missing(event), view.timeline):
                about = f"{file}:{line}"
                yield Finding(self, event.t, view.end, event.entity, about=about, event=event)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        event = found.event
        assert isinstance(event, SynchroniserJudged)
        place = line_location(*event.made_at)
        came = listed(
            f"{number}{'' if position else ' messages'} of {_named(topic)}"
            for position, (topic, number) in enumerate(_counts(event))
        )
        nothing = "the synchroniser hands on nothing"
        takes = (
            f"an ApproximateTimeSynchronizer wants stamps less than its slop, {duration(event.slop)}, apart"
            if event.slop
            else "a TimeSynchronizer wants stamps that are equal to the nanosecond"
        )
        if missing := _missing(event):
            topics = listed(map(_named, missing))
            return Explanation(
                f"no message of {topics} came: {nothing} of {came}",
                "a set has one message of each topic",
                f"publish on {topics}, or give it the name that its publisher has",
                place,
            )
        if unset := _of_stamp_zero(event):
            topics = listed(map(_named, unset))
            return Explanation(
                f"the stamps of {topics} are 0{_sent_by(unset, timeline)}: {nothing} of {came}",
                f"{takes}; a header's stamp is 0 until it is set",
                "set header.stamp before the message is published, by get_clock().now().to_msg()",
                place,
            )
        if event.apart < max(event.slop, 1):
            return Explanation(
                f"{nothing}, though there are stamps that belong together, in {came}",
                "when a message came, the queues had forgotten its partners: they were more than queue_size "
                "messages ago",
                "raise queue_size until the queues span the longest delay",
                place,
                remedies=by_edit(place, "keep ten times as many messages", lengthen_queues),
            )
        slop = next((each for each in _SLOPS if float(each) * SECOND > 1.5 * event.mostly), None)
        if slop is None:
            newest = listed(
                f"{stamp / SECOND:.1f} s on {_named(topic)}"
                for topic, stamp in zip(event.topics, event.stamps, strict=True)
            )
            return Explanation(
                f"the stamps are far apart, {newest} at last: {nothing}",
                f"{takes}; these seem to come from different clocks, such as a simulated one and the wall's",
                "stamp them all by one clock, by use_sim_time in all nodes or in none",
                place,
            )
        more = f"a slop of {slop}" if event.slop else f"an ApproximateTimeSynchronizer with slop={slop}"
        return Explanation(
            f"the stamps are at least {duration(event.apart)} apart; {nothing} of {came}",
            f"{takes}; it keeps the last messages of each topic until their partners come, and says nothing",
            f"take {more}, which most of these messages are within",
            place,
            remedies=by_edit(place, f"take {more}", allow_slop, slop),
        )


def _counts(event: SynchroniserJudged) -> Iterator[tuple[str, int]]:
    """Yield the topics that brought messages, with how many."""
    return ((topic, number) for topic, number in zip(event.topics, event.messages, strict=True) if number)


def _missing(event: SynchroniserJudged) -> list[str]:
    return [topic for topic, number in zip(event.topics, event.messages, strict=True) if not number]


def _of_stamp_zero(event: SynchroniserJudged) -> list[str]:
    return [topic for topic, stamp in zip(event.topics, event.stamps, strict=True) if not stamp]


def _named(topic: str) -> str:
    return topic or "an input without a topic"


def _is_heard_or_told(missing: Iterable[str], timeline: Timeline) -> bool:
    """Return whether topics that had brought nothing have brought something since, or QoS explains it."""
    whole, topics = Window(0, timeline.end + 1), set(missing)
    return any(each.topic in topics for each in timeline.mismatches) or any(
        each.kind is EntityKind.SUBSCRIPTION and each.name in topics and timeline.calls_of(each.id, whole)
        for each in (timeline.entities.values() if topics else ())
    )


def _sent_by(topics: Iterable[str], timeline: Timeline) -> str:
    """Return who publishes on topics: ``, as cam sends them``; empty if that is unknown."""
    first = [each.sender for topic in topics for each in timeline.sent_on(topic)[:1]]
    names = [who(each.entity, timeline) for each in first if each is not None]
    return f", as {listed(names)} sends them" if names else ""
