"""The rule on a thread of the program's own that waits for an event which nothing sets."""

from collections.abc import Iterator
from pathlib import Path

from sim.diagnosis.edits.flags import never_set
from sim.diagnosis.rule import CodeLocation, Explanation, Finding, Rule, Weight
from sim.diagnosis.timeline_view import TimelineView
from sim.quantities.nanoseconds import SECOND
from sim.trace.events import OwnThreadAt
from sim.trace.timeline import Timeline


class ThreadWaitsForNobody(Rule):
    """A thread that the program started waits without a timeout for what its file never sets, as an event.

    Not said of what the file hands on, for another one may set it then.
    """

    id = "thread-waits-for-nobody"
    summary = "a thread of the program waits for an event that nothing sets"
    weight = Weight.REMARK
    threshold = SECOND

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each such thread."""
        for at in view.timeline.own_threads_at(view.end):
            file, _, line = at.frames[-1]
            is_long = at.call != "" and view.end - at.t >= self.threshold
            if is_long and (missing := never_set(file, line)):
                yield Finding(self, at.t, view.end, about=at.name, detail=missing, event=at)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        assert isinstance(found.event, OwnThreadAt)
        file, _, line = found.event.frames[-1]
        name, call = Path(file).name, found.event.call
        return Explanation(
            f"the thread {found.about} waits in {call}(), and nothing in {name} calls {found.detail}",
            "without a timeout such a wait ends only if somebody ends it",
            f"call {found.detail} where the thread may go on, or wait with a timeout",
            CodeLocation(file, line, line),
        )
