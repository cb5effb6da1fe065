"""The rule on topics whose two ends have different names, and how names of topics and services are alike."""

from collections.abc import Collection, Iterable, Iterator
from difflib import SequenceMatcher

from sim.diagnosis.cures import Remedy
from sim.diagnosis.edits.names import rename
from sim.diagnosis.rule import CodeLocation, Explanation, Finding, Rule, by_edit, entity_of, made_at, place_of
from sim.diagnosis.timeline_view import TimelineView
from sim.diagnosis.words import who
from sim.trace.events import EntityKind
from sim.trace.model import EntityInfo, Nanoseconds
from sim.trace.timeline import Timeline

_ALIKE = 0.8
"""How alike the last parts of two names are, 0 to 1, if one may be the other misspelt."""
_SHORTEST = 4
"""Letters of a last part that tell enough if another one begins or ends with them."""
_MOST = 50
"""Names that are compared; a program with more unheard topics than these is not a beginner's."""


class MisspeltTopic(Rule):
    """Nobody publishes on a subscription's topic, and nobody hears a topic of nearly the same name.

    Once both have been so for a while, the two ends are probably meant to be one topic.
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
        for each in silent if unheard else ():
            near = nearest(each.name, unheard)
            since = timeline.sent_on(near)[0].at if near else view.end
            if view.end - since >= self.threshold:
                yield Finding(self, since, view.end, each.id, about=near)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        """Name both ends."""
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


def nearest(name: str, known: Iterable[str]) -> str:
    """The one of some names that another may be misspelt for; "" for none."""
    likeness = {each: _likeness(name, each) for each in known}
    best = max(likeness, key=likeness.__getitem__, default="")
    return best if best and likeness[best] >= _ALIKE else ""


def _likeness(name: str, other: str) -> float:
    """How alike two names are, 0 to 1: the last part counts most, its case and its namespace little."""
    one, two = (each.rpartition("/")[2].lower() for each in (name, other))
    short, long = sorted((one, two), key=len)
    if len(short) >= _SHORTEST and (long.startswith(short) or long.endswith(short)):
        return max(_ALIKE, SequenceMatcher(None, name, other).ratio())
    return SequenceMatcher(None, one, two).ratio()


def renaming(end: EntityInfo, name: str, verb: str) -> tuple[Remedy, ...]:
    """The remedy that has a subscription or a client use another name."""
    return by_edit(made_at(end), f"{verb} {name}", rename, end.name, name)


def offer(end: EntityInfo, timeline: Timeline) -> tuple[str, str, tuple[Remedy, ...]]:
    """Which offered service a client may be meant for: what differs, what to do, and what can be tried."""
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
