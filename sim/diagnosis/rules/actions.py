"""Rules on the goals of actions: accepted and never executed, or going on after their cancel."""

from collections.abc import Iterator

from sim.diagnosis.edits.actions import end_if_cancelled, execute_accepted_goals
from sim.diagnosis.rule import (
    Explanation,
    Finding,
    Rule,
    by_edit,
    entity_of,
    line_of,
    made_at,
)
from sim.diagnosis.timeline_view import TimelineView
from sim.diagnosis.words import often, who
from sim.quantities.durations import duration
from sim.quantities.nanoseconds import SECOND
from sim.trace.events import EntityKind, NoticeKind
from sim.trace.model import Nanoseconds, Window
from sim.trace.timeline import Timeline

_LATE = 2 * SECOND
"""How long after the accepted cancel the engine tells of it."""


class CancelIgnored(Rule):
    """An execute callback goes on after the cancel of its goal was accepted, and does not look at that.

    Source: rclpy's ``ServerGoalHandle``, which ``canceled()`` and the like end, and nothing else.
    """

    id = "cancel-ignored"
    summary = "an action's execute callback does not look whether its goal is cancelled"

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each goal that the engine reports; of several at once, until the first one ends."""
        for notice in view.timeline.notices:
            if notice.kind is NoticeKind.CANCEL_IGNORED:
                spans = view.timeline.spans_of(notice.entity, Window(notice.t, notice.t + 1))
                until = min((span.end_at(view.end) for span in spans), default=view.end)
                yield Finding(self, notice.t - _LATE, until, notice.entity)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        subject = who(found.subject, timeline)
        place = line_of(found.subject, Window(found.at, found.until), timeline)
        made = timeline.entities[found.subject].made_at
        how = "has gone on" if found.until >= timeline.end else "went on"
        return Explanation(
            f"{subject} {how} for {duration(found.lasted)} after the cancel of its goal was accepted, "
            f"without a look at is_cancel_requested in the first {duration(_LATE)}{often(found.count)}",
            "an accepted cancel stops nothing by itself: it only sets is_cancel_requested, and the goal ends "
            "as the callback says",
            f"look at is_cancel_requested in each round of {subject}; if it is set, call canceled() and "
            "return a result",
            place,
            remedies=by_edit(place, "end the goal in its loop once it is cancelled", end_if_cancelled, made),
        )


class GoalNeverExecuted(Rule):
    """A goal was accepted, for its client asks for the result, and the execute callback never runs.

    Source: rclpy's ``ActionServer``, which leaves it to ``handle_accepted_callback`` to execute a goal.
    """

    id = "goal-never-executed"
    summary = "an action's goal is accepted and never executed"
    threshold: Nanoseconds = 3 * SECOND

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each server none of whose goals has been executed, unless something keeps its executor."""
        asked = {
            call.service: call.sent
            for call in view.now.pending_calls
            if call.service.endswith(_RESULT) and view.end - call.sent >= self.threshold
        }
        if not asked or self._keeps_an_executor(view):
            return
        for entity in view.few_entities:
            sent = asked.get(entity.name + _RESULT)
            is_execute = entity.kind is EntityKind.WAITABLE and entity.callback
            if sent is None or not is_execute:
                continue
            if not view.timeline.spans_of(entity.id, Window(0, view.end + 1)):
                yield Finding(self, sent, view.end, entity.id, entity.id)

    def _keeps_an_executor(self, view: TimelineView) -> bool:
        """Whether something has run or waited for a second, for which goals may wait, too."""
        begun = [span.start for span in view.now.running.values()]
        begun += [wait.since for wait in view.now.waiting.values()]
        return any(view.end - each >= SECOND for each in begun)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        server = entity_of(found, timeline)
        made, execute = made_at(server), who(found.subject, timeline)
        cure = "leave handle_accepted_callback out: goals are executed at once"
        return Explanation(
            f"a goal of {server.name} was accepted, and {execute} has never been called: its result has been "
            f"waited for for {duration(found.lasted)}",
            "with a handle_accepted_callback, a goal is executed when the program calls "
            "goal_handle.execute(), at once or later",
            f"call goal_handle.execute() in the callback, or {cure}",
            made,
            for_ever=True,
            remedies=by_edit(made, cure, execute_accepted_goals),
        )


_RESULT = "/_action/get_result"
