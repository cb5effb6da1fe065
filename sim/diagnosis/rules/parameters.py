"""The rule on parameter callbacks that set what is being set."""

from collections.abc import Iterator

from sim.diagnosis.rule import Explanation, Finding, Rule
from sim.diagnosis.timeline_view import TimelineView
from sim.trace.events import Notice, NoticeKind
from sim.trace.timeline import Timeline


class ParameterOverruled(Rule):
    """An on-set callback sets the parameter that it validates; the requested value is stored after that.

    Source: rclpy's ``Node._set_parameters_atomically_common``, which stores after the callbacks.
    """

    id = "parameter-overruled"
    summary = "a parameter callback sets the parameter that is being set"

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each parameter once, as the engine reports it."""
        for notice in view.timeline.notices:
            if notice.kind is NoticeKind.OVERRULED and notice.t <= view.end:
                yield Finding(self, notice.t, notice.t, notice.entity, about=notice.problem, event=notice)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        notice = found.event
        assert isinstance(notice, Notice)
        return Explanation(
            notice.problem,
            "an on-set callback is asked before the parameter is stored: what it sets is stored first, and "
            "what was asked for last",
            notice.advice,
            None,  # the line stands in the notice
        )
