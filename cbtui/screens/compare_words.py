"""What a comparison says about each of the runs on screen, and about keys that do nothing there."""

from collections.abc import Sequence

from rich.cells import cell_len

from cbtui.keys.action import KeyAction, Scope
from cbtui.keys.refused import NOT_IN_COMPARISON
from cbtui.keys.signs import signs_of
from cbtui.looks.theme import Charset, Ink, Role, TextRun
from cbtui.runs.compared_runs import ComparedSide
from cbtui.text.cells import fit
from cbtui.widgets.lanes.rows import ever_ran
from sim.quantities.durations import timestamp
from sim.quantities.nanoseconds import SECOND
from sim.trace.descriptions import executor_label
from sim.trace.figures.comparison_rows import RUNS
from sim.trace.figures.losses import all_losses
from sim.trace.model import Nanoseconds

_GAP = "   "
_PLAIN = Ink(Role.TEXT)
_STRONG = Ink(Role.STRONG)


def about(number: int, side: ComparedSide, width: int, charset: Charset) -> tuple[TextRun, ...]:
    """Return the line above a run's lanes: its name, end and failure, what it lost and its executor.

    A failure that is too long for the width is cut.
    """
    timeline = side.timeline
    begun = "goes on" if timeline.entities else "is starting"
    state = begun if side.alive() else f"ends at {timestamp(timeline.end)}"
    losses = all_losses(timeline, timeline.end)
    lost = f"lost {'-' if losses is None else losses}"
    ended = timeline.ended
    name = f" {RUNS[number]}  {side.name}"
    failure = ended.reason if ended is not None and ended.failed else ""
    room = width - len(f"{name}{_GAP}{state}{_GAP}{_GAP}{lost}")
    if cell_len(failure) > room:
        failure = fit(failure, max(0, room), charset).rstrip()
    facts = [text for text in (state, failure, lost, executor_label(timeline)) if text]
    return (TextRun(name, _STRONG), *(TextRun(f"{_GAP}{fact}", _PLAIN) for fact in facts))


def shorter(first: ComparedSide, second: ComparedSide) -> str:
    """Return which run is the shorter one, and where it ends."""
    shorter = second.timeline.end < first.timeline.end
    side = second if shorter else first
    until = "has come to" if side.alive() else "ends at"
    return f"{RUNS[shorter]} {until} {timestamp(side.timeline.end)}"


def only_begun(first: ComparedSide, second: ComparedSide) -> str:
    """Return which run has only begun: no callback has run, nor had one in the other run by then; or "".

    On the real clock the beginnings of two runs do not last equally long.
    """
    for name, side, other in zip(RUNS, (first, second), (second, first), strict=True):
        end = side.timeline.end
        by_then = max(0, end - SECOND) if side.timeline.is_real else end
        if side.alive() and end < other.timeline.end and not (_ran(side, end) or _ran(other, by_then)):
            return f"no callback has run yet in {name}, which has come to {timestamp(end)}"
    return ""


def _ran(side: ComparedSide, by: Nanoseconds) -> bool:
    return any(ever_ran(side.timeline, thread, by) for thread in side.timeline.threads)


def why_nothing(meant: Sequence[KeyAction], charset: Charset) -> list[str]:
    """Return the sentence on why a key with these actions does nothing; none where it only takes back."""
    reasons = [NOT_IN_COMPARISON[each.name] for each in meant if each.name in NOT_IN_COMPARISON]
    if not reasons and meant[0].scope is Scope.LESSON:
        sign = signs_of(meant[:1], charset)
        return [f"{sign}, {meant[0].label}, works in a run, not in a comparison."]
    return reasons[:1]
