"""Rules on answers of rclpy that a program makes nothing of, and on slips that Python passes over."""

from collections.abc import Iterator
from dataclasses import replace

from sim.diagnosis.edits.functions import await_coroutine
from sim.diagnosis.rule import Explanation, Finding, Rule, Weight, by_edit, line_location
from sim.diagnosis.timeline_view import TimelineView
from sim.diagnosis.words import awaiting, must_answer, who
from sim.trace.events import EntityId, EntityKind, GroupKind, Notice, NoticeKind
from sim.trace.model import Window
from sim.trace.timeline import Timeline

KINDS = (NoticeKind.EARLY_RESULT, NoticeKind.REFUSAL_OVERLOOKED, NoticeKind.REJECTION_OVERLOOKED)


class AnswerOverlooked(Rule):
    """A program asks for a result before there can be one, or drops an answer that refuses what it asks for.

    That is a parameter, or a goal whose result it asks for nevertheless.
    """

    id = "answer-overlooked"
    summary = "a result is asked for too early, or a refusal is not looked at"
    weight = Weight.REMARK

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each line once, as the engine reports it."""
        for notice in view.timeline.notices:
            if notice.kind in KINDS and notice.t <= view.end:
                about = f"{notice.place[0]}:{notice.place[1]}"
                yield Finding(self, notice.t, notice.t, notice.entity, about=about, event=notice)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        notice = _notice_of(found)
        subject = who(found.subject, timeline) if found.subject else "the program"
        if notice.kind is NoticeKind.EARLY_RESULT:
            what = f"{subject} asks a future for its result() as soon as the request is sent: that is None"
            why = "result() does not wait, and the reply comes to a callback after this one"
            cure = "wait for it by rclpy.spin_until_future_complete(node, future)"
            if found.subject:
                cure = awaiting(found.subject, timeline)
            if not must_answer(found.subject, timeline):
                cure = f"use the result in a done-callback, by future.add_done_callback(), or {cure}"
        elif notice.kind is NoticeKind.REJECTION_OVERLOOKED:
            what, cure = notice.problem, notice.advice
            why = (
                "the reply to a goal tells whether the server takes it, and only a goal it takes has a result"
            )
        else:
            what = f"{subject} does not look at what set_parameters() returns: {notice.problem}"
            why = "a refused parameter keeps its value, and only the result that is returned tells"
            cure = "look whether each result is successful, and log its reason if not"
        return Explanation(what, why, cure, line_location(*notice.place))

    def weigh(self, found: Finding, timeline: Timeline) -> Weight | None:
        """Irrelevant if the callback raised: that is told."""
        spans = timeline.spans_of(found.subject, Window(found.at, found.at + 1))
        return None if any(span.error for span in spans) else self.weight


class Slip(Rule):
    """A line does not do what it seems to: callbacks share a variable, nothing runs, answers or is sent."""

    id = "slip"
    summary = "callbacks of a loop share its variable, never run or answer, or nothing is sent"

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each line once, as the engine reports it."""
        for notice in view.timeline.notices:
            if notice.kind in _WHY and notice.t <= view.end:
                about = f"{notice.place[0]}:{notice.place[1]}"
                yield Finding(self, notice.t, notice.t, notice.entity, about=about, event=notice)

    def kind(self, found: Finding, timeline: Timeline) -> str:
        """Distinguish them."""
        return _notice_of(found).kind.value.replace(" ", "-")

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        notice = _notice_of(found)
        advice, place = notice.advice, line_location(*notice.place)
        is_made = notice.kind is NoticeKind.NEVER_AWAITED
        remedies = by_edit(place, advice, await_coroutine) if is_made else ()
        if is_made and (client := _client_beside(notice.entity, timeline)):
            own = f"give {who(notice.entity, timeline)} a callback group of its own"
            advice += f"; if it awaits a reply of {client}, {own} too, for it keeps its group meanwhile"
            remedies += tuple(replace(each, own_groups=(notice.entity,)) for each in remedies)
        return Explanation(notice.problem, _WHY[notice.kind], advice, place, remedies=remedies)

    def weigh(self, found: Finding, timeline: Timeline) -> Weight | None:
        """Irrelevant once something was sent on the topic after all."""
        return None if _notice_of(found).topic in timeline.names_sent else self.weight


def _client_beside(entity: EntityId, timeline: Timeline) -> str:
    """Return the service of a client in a callback's mutually exclusive group; "" for none."""
    group = timeline.groups.get(timeline.entities[entity].group) if entity else None
    if group is None or group.kind is not GroupKind.EXCLUSIVE:
        return ""
    clients = (each for each in timeline.group_members(group.id) if each.kind is EntityKind.CLIENT)
    return next((each.name for each in clients), "")


_WHY = {
    NoticeKind.LATE_BOUND: "a function looks up its variables when called, and by then the loop is over",
    NoticeKind.NEVER_AWAITED: "calling an async def only makes a coroutine, which runs when it is awaited",
    NoticeKind.NEVER_ITERATED: "rclpy calls a callback and drops what it returns, also a generator",
    NoticeKind.INACTIVE: "a lifecycle publisher drops what is published until on_activate() has activated it",
    NoticeKind.UNANSWERED: "such a callback is asked whether the values may be set, and None is no answer",
}


def _notice_of(found: Finding) -> Notice:
    assert isinstance(found.event, Notice)
    return found.event
