"""The rule on answers of rclpy that a program makes nothing of."""

from collections.abc import Iterator

from sim.diagnosis.rule import Explanation, Finding, Rule, Weight, line_location
from sim.diagnosis.timeline_view import TimelineView
from sim.diagnosis.words import awaiting, must_answer, who
from sim.trace.events import Notice, NoticeKind
from sim.trace.model import Window
from sim.trace.timeline import Timeline

KINDS = (NoticeKind.EARLY_RESULT, NoticeKind.REFUSAL_OVERLOOKED)


class AnswerOverlooked(Rule):
    """A program asks for a result before there can be one, or drops the answer that refuses a parameter."""

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
        notice = found.event
        assert isinstance(notice, Notice)
        subject = who(found.subject, timeline) if found.subject else "the program"
        if notice.kind is NoticeKind.EARLY_RESULT:
            what = f"{subject} asks a future for its result() as soon as the request is sent: that is None"
            why = "result() does not wait, and the reply comes to a callback after this one"
            cure = awaiting(subject)
            if not must_answer(found.subject, timeline):
                cure = f"use the result in a done-callback, by future.add_done_callback(), or {cure}"
        else:
            what = f"{subject} does not look at what set_parameters() returns: {notice.problem}"
            why = "a refused parameter keeps its value, and only the result that is returned tells"
            cure = "look whether each result is successful, and log its reason if not"
        return Explanation(what, why, cure, line_location(*notice.place))

    def weigh(self, found: Finding, timeline: Timeline) -> Weight | None:
        """Irrelevant if the callback raised: that is told."""
        spans = timeline.spans_of(found.subject, Window(found.at, found.at + 1))
        return None if any(span.error for span in spans) else self.weight
