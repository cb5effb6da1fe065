"""The rule on misspelt topics, and the likeness of names of topics and services."""

from collections.abc import Collection, Iterable, Iterator
from difflib import SequenceMatcher

from sim.diagnosis.cures import Remedy
from sim.diagnosis.edits.names import rename, rename_publisher
from sim.diagnosis.rule import CodeLocation, Explanation, Finding, Rule, by_edit, entity_of, made_at, place_of
from sim.diagnosis.timeline_view import TimelineView
from sim.diagnosis.words import who
from sim.trace.events import VELOCITY_TOPIC, EntityKind
from sim.trace.model import EntityInfo, Nanoseconds
from sim.trace.timeline import Timeline

_ALIKE = 0.8
"""The least likeness, 0 to 1, of a name's last part and its misspelling."""
_SHORTEST = 4
"""The least length of a last part that counts as alike if the other begins or ends with it."""
_MOST = 50
"""Limit for the names that are compared; a beginner's program has fewer unheard topics."""


class MisspeltTopic(Rule):
    """A subscription's topic has no publisher, and a topic of nearly the same name no subscription.

    The robot's ``/cmd_vel`` counts as a subscription's. If that lasts for a while, both ends are probably
    meant to be one topic.
    """

    id = "misspelt-topic"
    summary = "a subscription hears nothing, and a topic of nearly the same name is published"
    threshold: Nanoseconds = 500_000_000

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each subscription that hears nothing, with the topic that it may be meant for."""
        timeline = view.timeline
        ends = [each for each in timeline.entities.values() if each.kind is EntityKind.SUBSCRIPTION]
        heard = {each.name for each in ends}
        unheard = [name for name in timeline.names_sent if name not in heard]
        unheard = [name for name in unheard if name not in timeline.services_called][:_MOST]
        silent = [each for each in ends if each.made_at[0] and not timeline.sent_on(each.name)][:_MOST]
        ends_of_pairs = [(each.id, each.name) for each in silent]
        if timeline.arena is not None and not timeline.sent_on(VELOCITY_TOPIC):
            ends_of_pairs.append((0, VELOCITY_TOPIC))
        for entity, name in ends_of_pairs if unheard else ():
            near = nearest(name, unheard)
            since = timeline.sent_on(near)[0].at if near else view.end
            if view.end - since >= self.threshold:
                yield Finding(self, since, view.end, entity, about=near)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        if not found.subject:
            return _explain_robot(found.about, timeline)
        end = entity_of(found, timeline)
        first = timeline.sent_on(found.about)[0].sender
        by = "" if first is None else f" by {who(first.entity, timeline)}"
        return Explanation(
            f"{who(found.subject, timeline)} hears nothing: nobody publishes on {end.name}, and nobody "
            f"hears {found.about}, which is published{by}",
            "a publisher and a subscription meet only if their topics have the same name, letter by letter",
            f"if one topic is meant, give it one name: subscribe to {found.about}, or publish on {end.name}",
            made_at(end) or place_of(end.id, timeline),
            remedies=renaming(end, found.about, "subscribe to"),
        )


def _explain_robot(published: str, timeline: Timeline) -> Explanation:
    sender = timeline.sent_on(published)[0].sender
    by = "the program" if sender is None else who(sender.entity, timeline)
    place = None if sender is None else place_of(sender.entity, timeline)
    return Explanation(
        f"the robot hears nothing: nobody publishes on {VELOCITY_TOPIC}, and nobody hears {published}, "
        f"on which {by} publishes",
        f"the robot does what it is told on {VELOCITY_TOPIC}, letter by letter, and hears no other topic",
        f"if the robot is meant, publish on {VELOCITY_TOPIC}",
        place,
        remedies=by_edit(place, f"publish on {VELOCITY_TOPIC}", rename_publisher, published, VELOCITY_TOPIC),
    )


def nearest(name: str, known: Iterable[str]) -> str:
    """Return which of the known names ``name`` may be a misspelling of; "" for none."""
    likeness = {each: _likeness(name, each) for each in known}
    best = max(likeness, key=likeness.__getitem__, default="")
    return best if best and likeness[best] >= _ALIKE else ""


def _likeness(name: str, other: str) -> float:
    """Return the likeness of two names, 0 to 1: of their last parts, whatever their case."""
    one, two = (each.rpartition("/")[2].lower() for each in (name, other))
    short, long = sorted((one, two), key=len)
    if len(short) >= _SHORTEST and (long.startswith(short) or long.endswith(short)):
        return max(_ALIKE, SequenceMatcher(None, name, other).ratio())
    return SequenceMatcher(None, one, two).ratio()


def renaming(end: EntityInfo, name: str, verb: str) -> tuple[Remedy, ...]:
    """Return the remedy that gives a subscription or client another name."""
    return by_edit(made_at(end), f"{verb} {name}", rename, end.name, name)


def offer(end: EntityInfo, timeline: Timeline) -> tuple[str, str, tuple[Remedy, ...]]:
    """Return how a client's probable service differs, what to do, and the remedies; empty for none."""
    offered = {each.name: each for each in timeline.entities.values() if each.kind is EntityKind.SERVICE}
    same = offered.get(end.name)
    if same is not None and end.interface_type and same.interface_type not in ("", end.interface_type):
        return (
            f"as {end.interface_type}, but it is offered as {same.interface_type}",
            f"give both ends of {end.name} the same type: {_ends(end, same)}",
            (),
        )
    near = offered.get(nearest(end.name, _others(offered, end.name)))
    if near is None:
        return "", "", ()
    place = made_at(near)
    where = "" if place is None else f" ({place})"
    return "", f"call {near.name}, which is offered{where}", renaming(end, near.name, "call")


def _others(names: Collection[str], name: str) -> list[str]:
    return [each for each in names if each != name]


def _ends(client: EntityInfo, service: EntityInfo) -> str:
    places: list[tuple[str, CodeLocation | None]] = [
        ("client", made_at(client)),
        ("service", made_at(service)),
    ]
    return " and ".join(f"the {kind} of {place}" for kind, place in places if place) or "look at both"
