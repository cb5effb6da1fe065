"""Rules on service calls that are never answered."""

import re
from collections.abc import Iterator

from sim.diagnosis.cures import Remedy, remedy_for_waits
from sim.diagnosis.edits.functions import return_response
from sim.diagnosis.edits.names import asked_within, made_for, served_at
from sim.diagnosis.rule import (
    CodeLocation,
    Explanation,
    Finding,
    Rule,
    Weight,
    by_edit,
    entity_of,
    line_location,
    line_of,
    made_at,
    place_of,
)
from sim.diagnosis.rules.edits import edits_for_service
from sim.diagnosis.rules.endless import kept_waiting
from sim.diagnosis.rules.names import offer
from sim.diagnosis.rules.timing import calls_outrun
from sim.diagnosis.time_limits import time_limit
from sim.diagnosis.timeline_view import TimelineView
from sim.diagnosis.words import listed, often, until_when, who
from sim.quantities.durations import duration
from sim.quantities.nanoseconds import SECOND
from sim.trace.events import EntityId, EntityKind, ProgramAt
from sim.trace.model import EntityInfo, Span, Window
from sim.trace.timeline import Timeline

_CALLS_IN_TURN = 3
"""The number of calls, or of waits in vain, one right after the other, that tell a habit."""

_RETURNED = re.compile(r"got <class '(?:[\w<>]+\.)*(\w+)'>$")
"""The class of what a service's callback returned, in the error that comes of it; real rclpy names none."""


class UnreturnedResponse(Rule):
    """A service's callback raised, or returned no response, so its caller gets no reply."""

    id = "unreturned-response"
    summary = "a service's callback ends without an answer"

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each finished call of a service's callback without a reply."""
        for entity in view.entities(EntityKind.SERVICE):
            for span in view.spans(entity.id):
                if span.message in view.unanswered and self._is_over(span, view):
                    assert span.end is not None
                    raised = "" if span.no_response else span.error
                    yield Finding(self, span.start, span.end, entity.id, entity.id, detail=raised)

    def kind(self, found: Finding, timeline: Timeline) -> str:
        """No lesson is on this: where it is found in one, it is an effect."""
        return "no-response"

    def _is_over(self, span: Span, view: TimelineView) -> bool:
        if span.end is None:
            return False
        ended = view.timeline.ended
        if ended is not None and span.end >= ended.t and not span.error:
            return False  # the end of the run cut it short
        group = view.timeline.entities[span.entity].group
        return bool(span.error) or span.entity not in view.now.holders.get(group, ())

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        subject, service = who(found.subject, timeline), entity_of(found, timeline).name
        place = place_of(found.subject, timeline)
        remedies: tuple[Remedy, ...] = ()
        if found.detail:
            what, error = f"{subject} raised", f": {found.detail}"
            cure = f"fix what raises, or catch it in {subject} and return a response that says so"
        else:
            what, error = f"{subject} returned no response", ""
            cure = f"end {subject} with: return response"
            remedies = by_edit(place, cure, return_response)
            spans = timeline.spans_of(found.subject, Window(found.at, found.at + 1))
            known = _RETURNED.search(spans[0].error or "") if spans else None
            if known and known[1] != "NoneType":
                what = f"{subject} returned a value of type {known[1]}, and not its response"
                cure = f"set the fields of the response that {subject} is given, and return that"
                remedies = ()
        return Explanation(
            f"{what}, so the caller of {service} waits for ever{error}{often(found.count)}",
            "only what a service's callback returns is sent to the caller",
            cure,
            place,
            remedies=remedies,
        )

    def weigh(self, found: Finding, timeline: Timeline) -> Weight | None:
        """Irrelevant if the exception ended the program: that is the problem."""
        ended = timeline.ended
        return None if ended is not None and found.detail and found.detail == ended.error else self.weight


class ServiceFallsBehind(Rule):
    """Requests come faster than a service answers them, so each has waited longer than the one before."""

    id = "service-falls-behind"
    summary = "a service is asked faster than it answers, so that requests pile up"
    is_effect = True
    threshold = SECOND

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each call that took an old request, if it followed others at once that took younger ones."""
        for entity in view.entities(EntityKind.SERVICE):
            for span in view.spans(entity.id):
                if span.age >= self.threshold and (
                    calls := calls_outrun(entity, span, _CALLS_IN_TURN, view.timeline)
                ):
                    before = calls[-2]  # the last may still run
                    at, until = before.start, before.end_at(view.end)
                    yield Finding(self, at, until, entity.id, about=entity.name, size=span.age)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        subject, until = who(found.subject, timeline), Window(0, timeline.end + 1)
        calls = [each for each in timeline.calls_within(until) if each.service == found.about]
        open_ = sum(each.replied is None for each in calls)
        unanswered = f"; {open_} of {len(calls)} calls have no reply" if open_ else ""
        callers = [who(each.caller, timeline) for each in calls if each.caller]
        return Explanation(
            f"{subject} falls behind: it takes {duration(found.lasted)} a request, and took one that was "
            f"{duration(found.size)} old{unanswered}",
            "requests come faster than that; one that its caller has given up is answered all the same, and "
            "keeps the next one waiting",
            f"let {listed(callers) if callers else 'the caller'} ask again only when the reply is there, or "
            f"{subject} return sooner; what takes long is an action's",
            line_of(found.subject, Window(found.at, found.until), timeline)
            or place_of(found.subject, timeline),
        )


class NobodyOffers(Rule):
    """A service was called while nobody offered it: the request is lost, and no reply will come."""

    id = "nobody-offers"
    summary = "a service is called that nobody offers"

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each lost request."""
        for call in view.calls():
            if call.lost and call.replied is None:  # on real ROS 2 it may arrive all the same
                yield Finding(self, call.sent, call.sent, call.caller, about=call.service)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        caller = f"{who(found.subject, timeline)} called" if found.subject else "somebody called"
        client = _client_of(found, timeline)
        differs, cure, remedies = ("", "", ()) if client is None else offer(client, timeline)
        made = None if client is None else made_at(client)
        place = place_of(found.subject, timeline)
        maker, line = served_at(made.file, found.about) if made else ("", 0)
        asked, later = _asked_at_line(place, made), ""
        why = "a request is not kept for a service that comes later"
        if differs:
            why = "a client and a service meet only if they have the same name and the same type"
        elif not cure and any(
            each.kind is EntityKind.SERVICE and each.name == found.about
            for each in timeline.entities.values()
        ):
            cure = "call wait_for_service() first"
        elif not cure and maker not in ("", "__init__", "the program"):
            later = f"; {maker} would create it at line {line}"
            cure = f"create {found.about} in __init__, or ask service_is_ready() first, and return without it"
        elif not cure:
            cure = (
                "check the service's name, start the node that offers it, and call wait_for_service() first"
            )
        return Explanation(
            f"{caller} {found.about}{f' {differs}' if differs else ', which nobody offered'}: "
            f"no reply will come{often(found.count)}{later}",
            why,
            cure,
            (made if differs else asked) or made or place,
            remedies=remedies,
        )


def _asked_at_line(place: CodeLocation | None, made: CodeLocation | None) -> CodeLocation | None:
    """Return the line of a callback at which it calls the client that is made at another; None if unknown."""
    if place is None or made is None or place.file != made.file:
        return None
    line = asked_within(place.file, place.first_line, place.last_line, made.first_line)
    return line_location(place.file, line)


def _client_of(found: Finding, timeline: Timeline) -> EntityInfo | None:
    """Return the client of a service in a callback's node; in any node if the caller is unknown."""
    node = timeline.entities[found.subject].node if found.subject else 0
    clients = (each for each in timeline.entities.values() if each.kind is EntityKind.CLIENT)
    return next((each for each in clients if each.name == found.about and node in (0, each.node)), None)


def _unserved(timeline: Timeline) -> list[EntityInfo]:
    """Return the clients of services that no node offers by that name and type."""
    known = timeline.entities.values()
    offered = {(each.name, each.interface_type) for each in known if each.kind is EntityKind.SERVICE}
    clients = (each for each in known if each.kind is EntityKind.CLIENT)
    return [each for each in clients if (each.name, each.interface_type) not in offered]


def _of(program: ProgramAt, timeline: Timeline) -> list[EntityInfo]:
    """Return such clients of a program: where there are several, those that its files made."""
    files, (file, _, line) = {file for file, _, _ in program.frames}, program.frames[-1]
    clients = [each for each in _unserved(timeline) if not program.process or each.made_at[0] in files]
    return _asked_at((file, line), clients)


def _of_callback(entity: EntityId, place: tuple[str, int], timeline: Timeline) -> list[EntityInfo]:
    """Return such clients of a callback's node for which it may wait at a place."""
    node = timeline.entities[entity].node
    return _asked_at(place, [each for each in _unserved(timeline) if each.node == node])


def _asked_at(place: tuple[str, int], clients: list[EntityInfo]) -> list[EntityInfo]:
    """Return those of some clients that are asked at a place; all if the source does not show which."""
    file, lines = place[0], made_for(*place)
    return [each for each in clients if each.made_at[0] == file and each.made_at[1] in lines] or clients


def _created_later(found: Finding, file: str) -> tuple[str, str]:
    """Say who creates a service that is waited for, if a file shows it, and return that function; else ""."""
    maker, line = served_at(file, found.about) if " and " not in found.about else ("", 0)
    by = f"; {maker} would create it at line {line}" if line else ""
    return f"which nobody has offered so far{by}", maker


class ServiceNeverComes(Rule):
    """A callback waits for a service that no node offers, and keeps its thread and its group."""

    id = "service-never-comes"
    summary = "a callback waits for a service that nobody offers"
    hangs_from = 0
    hides = frozenset(["waited-in-vain"])
    threshold = SECOND

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each callback that has waited longer than the threshold."""
        for each in view.positions:
            if each.call != "Client.wait_for_service" or view.end - each.start < self.threshold:
                continue
            if clients := _of_callback(each.entity, (each.file, each.line), view.timeline):
                about = listed(sorted({client.name for client in clients}))
                stuck, ends = frozenset([each.entity]), time_limit(each)
                yield Finding(self, each.start, view.end, each.entity, about=about, stuck=stuck, ends=ends)
        yield from self._of_program(view)

    def _of_program(self, view: TimelineView) -> Iterator[Finding]:
        """Yield a wait of the program itself, which therefore does not reach ``spin()``."""
        for at in view.timeline.programs_at(view.end):
            if at.call != "Client.wait_for_service" or view.end - at.t < self.threshold:
                continue
            if missing := [each.name for each in _of(at, view.timeline)]:
                yield Finding(
                    self, at.t, view.end, about=listed(sorted(missing)), ends=time_limit(at), event=at
                )

    def _explained_of_program(self, found: Finding, timeline: Timeline) -> Explanation:
        at = found.event
        assert isinstance(at, ProgramAt)
        file, _, line = at.frames[-1]
        clients = _of(at, timeline)
        program = " ".join(filter(None, ("the program", timeline.processes.get(at.process))))
        differs, cure, remedies = offer(clients[0], timeline) if clients else ("", "", ())
        unoffered, maker = _created_later(found, file)
        if maker and maker != "__init__":
            cure = f"create {found.about} before the wait"
        until = until_when(found.ends, timeline)
        return Explanation(
            f"{program} waits in wait_for_service(){until} for {found.about}, {differs or unoffered}, "
            f"and comes to no spin(){' before that' if until else ''}",
            "callbacks run only inside spin()",
            cure or f"check the service's name, and start the node that offers {found.about} before this one",
            CodeLocation(file, line, line),
            for_ever=found.until >= timeline.end and not found.ends,
            until=found.ends,
            remedies=remedies,
        )

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        if not found.subject:
            return self._explained_of_program(found, timeline)
        subject = who(found.subject, timeline)
        within = Window(found.at, found.until + 1)
        place = line_of(found.subject, within, timeline)
        asked = (place.file, place.first_line) if place else ("", 0)
        differs, meant, remedies = offer(_of_callback(found.subject, asked, timeline)[0], timeline)
        unoffered, maker = _created_later(found, place.file if place else "")
        kept = [each for each in kept_waiting(found, timeline) if who(each, timeline) == maker]
        start = meant or f"start the node that offers {found.about}"
        start += "; wait for it in __init__, before spin()"
        if maker and maker != "__init__":
            start = f"create {found.about} in __init__"
            unoffered += ", and can run only when the wait is over" if kept else ""
        room = remedy_for_waits(kept, found.subject, within, timeline)
        return Explanation(
            f"{subject} waits in wait_for_service(){until_when(found.ends, timeline)} for {found.about}, "
            f"{differs or unoffered}",
            "while it waits, it keeps its thread and its group, for ever without a timeout or in a loop",
            f"{start}, or ask service_is_ready() in {subject} and return",
            place,
            for_ever=found.until >= timeline.end and not found.ends,
            until=found.ends,
            remedies=remedies or (room, *edits_for_service(place, found.subject, timeline)),
        )

    def weigh(self, found: Finding, timeline: Timeline) -> Weight | None:
        """Irrelevant if the wait ended."""
        return self.weight if found.until >= timeline.end else None


class WaitedInVain(Rule):
    """A callback waits for a service that no node offers again and again, each time until its timeout.

    That the service is still to come is likely, unless one of nearly the same name is offered.
    """

    id = "waited-in-vain"
    summary = "a callback waits again and again, in vain, for a service that nobody offers"

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each wait that its timeout ended, if it is known for which service; not those of a loop."""
        for thread in view.timeline.threads:
            for at in view.timeline.positions_on(thread, view.window):
                if at.call != "Client.wait_for_service" or at.loop[0] or not at.end or not at.until:
                    continue
                clients = _of_callback(at.entity, (at.file, at.line), view.timeline)
                lasted = at.end - at.start
                if 2 * lasted > at.until - at.start and len(clients) == 1:  # seen late on the real clock
                    about = clients[0].name
                    yield Finding(self, at.start, at.end, at.entity, at.entity, about, size=lasted)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        subject, client = who(found.subject, timeline), _client_of(found, timeline)
        differs, meant, remedies = ("", "", ()) if client is None else offer(client, timeline)
        return Explanation(
            f"{subject} waited for {found.about} in vain{often(found.count)}, up to {duration(found.lasted)} "
            f"each: {differs and 'it is asked for '}{differs or 'nobody has offered it so far'}",
            "a client and a service meet only if they have the same name and the same type",
            meant or f"check the service's name, and start the node that offers {found.about}",
            (client and made_at(client)) or place_of(found.subject, timeline),
            remedies=remedies,
        )

    def weigh(self, found: Finding, timeline: Timeline) -> Weight | None:
        """Irrelevant if it happened seldom, or if the service came; a remark if it may come."""
        client = _client_of(found, timeline)
        if found.count < _CALLS_IN_TURN or client is None or client not in _unserved(timeline):
            return None
        differs, meant, _ = offer(client, timeline)
        is_made = client.made_at[0] and _created_later(found, client.made_at[0])[1]
        return self.weight if differs or (meant and not is_made) else Weight.REMARK
