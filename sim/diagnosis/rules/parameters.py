"""Rules on callbacks of parameters that set what is being set, or wait for what their node has to bring."""

from collections.abc import Iterator

from sim.diagnosis.edits.replies import calls_on_parameters
from sim.diagnosis.rule import Explanation, Finding, Rule, line_location
from sim.diagnosis.timeline_view import TimelineView, is_worker
from sim.diagnosis.words import group_of, who, with_threads
from sim.quantities.nanoseconds import SECOND
from sim.trace.descriptions import node_name
from sim.trace.events import EntityId, EntityKind, Notice, NoticeKind, Reason
from sim.trace.model import Blocked
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


class DeadlockOverParameter(Rule):
    """Parameters are being set from outside, and a callback of them waits for a reply that this keeps out.

    The hidden service that sets them is not on the trace, but holds the node's default group meanwhile.
    """

    id = "deadlock-over-a-parameter"
    summary = "a parameter callback waits for a reply that it keeps from coming"
    hangs_from = 0
    hides = frozenset(("group-starvation", "no-free-worker", "waited-in-vain"))
    threshold = SECOND

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each such wait, if a file of the program shows one callback that can be the one."""
        asked = [each for each in view.now.pending_calls if "/set_parameters" in each.service]
        for blocked in view.blocked if asked else ():
            is_long = blocked.end is None and view.end - blocked.start >= self.threshold
            kept = _kept_by_parameters(blocked, view) if is_long and not blocked.entity else 0
            file = view.timeline.entities[kept].made_at[0] if kept else ""
            _, line = calls_on_parameters(file)
            nodes = {call.service.rpartition("/")[0] for call in asked if call.sent <= blocked.start}
            if line and node_name(view.timeline.entities[kept].node, view.timeline) in nodes:
                yield Finding(
                    self,
                    blocked.start,
                    view.end,
                    kept,
                    about=blocked.service,
                    detail=file,
                    size=line,
                    thread=blocked.thread,
                    stuck=frozenset((kept,)),
                )

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        function, _ = calls_on_parameters(found.detail)
        subject, service = who(found.subject, timeline), found.about
        client = f"the client of {service}"
        wait = timeline.moment(found.until).waiting.get(found.subject)
        is_held = wait is None or wait.reason is Reason.GROUP_HELD
        kept = f"{group_of(found.subject, timeline)}, which the setting of parameters holds"
        needs = kept if is_held else "the only thread, which sets parameters"
        own = f"{subject} and {client} a callback group each"
        if timeline.entities[found.subject].kind is EntityKind.CLIENT:
            own = f"{client} a callback group of its own"
        threads = "" if is_worker(found.thread, timeline) else f", and spin with {with_threads(2)}"
        return Explanation(
            f"deadlock: {function}, a callback of parameters, waits for {service} for ever; {subject} waits "
            f"for {needs}",
            "a node sets parameters that come from outside in a service of its default group",
            "ask by call_async() in a callback of add_post_set_parameters_callback(); or give "
            f"{own}{threads}",
            line_location(found.detail, found.size),
            for_ever=found.until >= timeline.end,
        )


def _kept_by_parameters(blocked: Blocked, view: TimelineView) -> EntityId:
    """Return what a call that no callback makes waits for, if what is not on the trace keeps that; else 0."""
    for entity, wait in view.now.waiting.items():
        known = view.timeline.entities[entity]
        is_asked = known.name == blocked.service and known.kind in (EntityKind.SERVICE, EntityKind.CLIENT)
        if is_asked and not wait.holder:
            return entity
    return 0
