"""What a comparison says about each of the runs on screen."""

from cbtui.looks.theme import Ink, Role, TextRun
from cbtui.runs.compared_runs import ComparedSide
from sim.quantities.durations import timestamp
from sim.trace.descriptions import executor_label
from sim.trace.figures.comparison_rows import RUNS

_PLAIN = Ink(Role.TEXT)
_STRONG = Ink(Role.STRONG)


def about(number: int, side: ComparedSide) -> tuple[TextRun, ...]:
    """Return the line above a run's lanes: its name, end and failure, what it lost and its executor."""
    timeline = side.timeline
    state = "goes on" if side.alive() else f"ends at {timestamp(timeline.end)}"
    lost = f"lost {timeline.dropped(timeline.end)}"
    ended = timeline.ended
    failure = ended.reason if ended is not None and ended.failed else ""
    facts = [text for text in (state, failure, lost, executor_label(timeline)) if text]
    name = TextRun(f" {RUNS[number]}  {side.name}", _STRONG)
    return (name, *(TextRun(f"   {fact}", _PLAIN) for fact in facts))


def shorter(first: ComparedSide, second: ComparedSide) -> str:
    """Return which run is the shorter one, and where it ends."""
    shorter = second.timeline.end < first.timeline.end
    side = second if shorter else first
    until = "has come to" if side.alive() else "ends at"
    return f"{RUNS[shorter]} {until} {timestamp(side.timeline.end)}"
