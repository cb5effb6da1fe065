"""The rule on misspelt topics, and the likeness of names of topics and services."""

from collections.abc import Iterable, Iterator, Mapping
from difflib import SequenceMatcher, get_close_matches
from functools import lru_cache

from sim.diagnosis.cures import Remedy
from sim.diagnosis.edits.names import rename, rename_publisher
from sim.diagnosis.rule import CodeLocation, Explanation, Finding, Rule, by_edit, entity_of, made_at, place_of
from sim.diagnosis.timeline_view import TimelineView
from sim.diagnosis.words import who
from sim.trace.events import ROBOT_SERVICES, SENSOR_TOPICS, VELOCITY_TOPIC, EntityKind
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
    meant to be one topic. Of topics that others hear only one of the same type is taken to be meant, whose
    name differs by a slip. So is that of a sensor of the robot, which comes only where a topic is its own.
    """

    id = "misspelt-topic"
    summary = "a subscription hears nothing, and a topic of nearly the same name is published"
    threshold: Nanoseconds = 500_000_000

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each subscription that hears nothing, with the topic that it may be meant for."""
        timeline = view.timeline
        ends = [each for each in timeline.entities.values() if each.kind is EntityKind.SUBSCRIPTION]
        heard = {each.name: each.interface_type for each in ends}
        unheard = [name for name in timeline.names_sent if name not in heard]
        unheard = [name for name in unheard if name not in timeline.services_called][:_MOST]
        silent = [each for each in ends if each.made_at[0] and not timeline.sent_on(each.name)][:_MOST]
        sent = {name: kind for name, kind in heard.items() if name in timeline.names_sent}
        known = sent if timeline.arena is not None else SENSOR_TOPICS | sent
        pairs = [(each.id, nearest(each.name, unheard) or _meant(each, known)) for each in silent]
        if timeline.arena is not None and not timeline.sent_on(VELOCITY_TOPIC):
            pairs.append((0, nearest(VELOCITY_TOPIC, unheard)))
        for entity, near in pairs:
            first = timeline.sent_on(near)[:1] if near else ()
            since = first[0].at if first else timeline.begun
            if near and view.end - since >= self.threshold:
                yield Finding(self, since, view.end, entity, about=near, detail=near if near in sent else "")

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        if not found.subject:
            return _explain_robot(found.about, timeline)
        end = entity_of(found, timeline)
        sent = timeline.sent_on(found.about)
        first = sent[0].sender if sent else None
        by = "" if first is None else f" by {who(first.entity, timeline)}"
        silent = f"{who(found.subject, timeline)} hears nothing: nobody publishes on {end.name}"
        if not sent:
            what, cure = f"{silent}; did you mean {found.about}, which the lessons' robot publishes?", ""
        elif found.detail:
            what, cure = f"{silent}; did you mean {found.about}, which is published{by}?", ""
        else:
            what = f"{silent}, and nobody hears {found.about}, which is published{by}"
            cure = f", or publish on {end.name}"
        return Explanation(
            what,
            "a publisher and a subscription meet only if their topics have the same name, letter by letter",
            f"if one topic is meant, give it one name: subscribe to {found.about}{cure}",
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


def _meant(end: EntityInfo, sent: Mapping[str, str]) -> str:
    """Return which topic a subscription's may be a slip of, of those of its type; "" for none."""
    same = (name for name, kind in sent.items() if kind == end.interface_type)
    return next((name for name in same if is_slip(end.name, name)), "")


def nearest(name: str, known: Iterable[str]) -> str:
    """Return which of the known names ``name`` may be a misspelling of; "" for none."""
    likeness = {each: _likeness(name, each) for each in known}
    best = max(likeness, key=likeness.__getitem__, default="")
    return best if best and likeness[best] >= _ALIKE else ""


def _likeness(name: str, other: str) -> float:
    """Return the likeness of two names, 0 to 1: of their last parts, whatever their case.

    That ``_`` stands for ``/`` in one makes no difference.
    """
    if name.lower().replace("/", "_") == other.lower().replace("/", "_"):
        return 1.0
    one, two = (each.rpartition("/")[2].lower() for each in (name, other))
    short, long = sorted((one, two), key=len)
    if len(short) >= _SHORTEST and (long.startswith(short) or long.endswith(short)):
        return max(_ALIKE, SequenceMatcher(None, name, other).ratio())
    return SequenceMatcher(None, one, two).ratio()


@lru_cache(maxsize=4096)
def is_slip(name: str, other: str) -> bool:
    """Return whether two names of one namespace differ as by a slip.

    That is: in case, in two letters that are swapped, or in one letter inside a word, which is wrong or
    missing in one; an ``s`` may be missing at the end. Names that differ in a digit or in a short word, as
    those of two sensors do, are no slip.
    """
    (space, _, one), (other_space, _, two) = (each.lower().rpartition("/") for each in (name, other))
    if space != other_space or name == other or min(len(one), len(two)) < _SHORTEST:
        return False
    apart = [at for at, (a, b) in enumerate(zip(one, two, strict=False)) if a != b]
    if len(one) == len(two) and len(apart) != 1:
        pair = slice(min(apart, default=0), max(apart, default=0) + 1)
        return not apart or (len(apart) == 2 and len(one[pair]) == 2 and one[pair] == two[pair][::-1])
    short, long = sorted((one, two), key=len)
    at = min(apart, default=len(short))
    if short[at + (len(long) == len(short)) :] != long[at + 1 :]:
        return False
    around = long[max(at - 1, 0) : at + 2]
    return long[at].isalpha() and ((len(around) == 3 and around.isalpha()) or (short + "s" == long))


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
    fitting = (name for name, each in offered.items() if end.interface_type in ("", each.interface_type))
    near = nearest(end.name, [each for each in fitting if each != end.name])
    place = made_at(offered[near]) if near else None
    by = f"is offered{f' ({place})' if place else ''}"
    if not near:
        near = "".join(get_close_matches(end.name, ROBOT_SERVICES, 1, _ALIKE))
        by = "the robot offers"
    return ("", f"call {near}, which {by}", renaming(end, near, "call")) if near else ("", "", ())


def _ends(client: EntityInfo, service: EntityInfo) -> str:
    places: list[tuple[str, CodeLocation | None]] = [
        ("client", made_at(client)),
        ("service", made_at(service)),
    ]
    return " and ".join(f"the {kind} of {place}" for kind, place in places if place) or "look at both"
