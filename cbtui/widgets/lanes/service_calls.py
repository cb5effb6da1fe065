"""Draws service calls: when they were sent and answered, and who made them."""

from collections.abc import Collection, Iterable, Sequence
from itertools import islice

from cbtui.looks.theme import GLYPHS, Ink, Role
from cbtui.text.cells import CellRow
from cbtui.widgets.lanes.scale import TimeScale
from sim.quantities.durations import duration
from sim.quantities.plural import counted
from sim.trace.model import Call, Nanoseconds
from sim.trace.timeline import Timeline

MARK = Ink(Role.MARK)
FAINT = Ink(Role.FAINT)

_LATEST = 500
"""The most calls that a picture shows."""


class LatestCalls:
    """The latest calls of a run, the newest first."""

    def __init__(self, timeline: Timeline) -> None:
        self._none = "none recorded" if timeline.begun else "not called"
        self.latest = list(islice(reversed(timeline.calls), _LATEST))
        self._by_service: dict[str, list[Call]] = {}
        for call in self.latest:
            self._by_service.setdefault(call.service, []).append(call)

    def of(self, service: str) -> Sequence[Call]:
        """Return a service's calls, the latest first."""
        return self._by_service.get(service, ())

    def summary(self, service: str, now: Nanoseconds) -> str:
        """Return how many calls were sent by ``now``, as far as is known, and the duration of the last one.

        While that one has no reply: how long the oldest such call has had none.
        """
        sent = [call for call in self.of(service) if call.sent <= now]
        if not sent:
            return self._none
        count = counted(len(sent), "call")
        last = sent[0]
        if last.replied is not None and last.replied <= now:
            return f"{count}, {duration(last.replied - last.sent)}"
        return f"no reply {duration(now - unanswered(sent, now)[-1].sent)}"


def unanswered(calls: Iterable[Call], now: Nanoseconds) -> list[Call]:
    """Return the calls that were sent by a moment and had no reply then."""
    return [call for call in calls if call.sent <= now and (call.replied is None or call.replied > now)]


def draw_calls(row: CellRow, calls: Sequence[Call], scale: TimeScale, now: Nanoseconds, key: str) -> None:
    """Mark when calls were sent (▲, with the user's ``key`` if it sent them) and answered (◂)."""
    glyphs = GLYPHS[row.charset]
    sent_at = {scale.column_of(call.sent) for call in calls}
    for call in calls:
        sent = scale.column_of(call.sent)
        replied = scale.column_of(now if call.replied is None else call.replied)
        if replied < 0 or sent >= scale.columns:
            continue
        for column in range(max(sent, 0), min(replied, scale.columns)):
            if row.blank(column, column + 1):
                row.put(column, glyphs.point, FAINT)
        row.put(sent, glyphs.up, MARK)
        name = _written(call, sent, key, sent_at)
        for column, letter in enumerate(name, sent + 1):
            row.put(column, letter, MARK)
        back = max(replied, sent + 1 + len(name))
        if call.replied is not None and back not in sent_at:
            row.put(back, glyphs.back, MARK)


def marked_columns(calls: Sequence[Call], scale: TimeScale, key: str) -> set[int]:
    """Return the columns of marked calls and the columns beside them, which keep marks apart."""
    marks: set[int] = set()
    for call in calls:
        sent, replied = scale.column_of(call.sent), scale.column_of(call.replied or call.sent)
        marks.update(range(sent - 1, sent + len(key) + 3), range(replied - 1, replied + 2))
    return marks


def _written(call: Call, sent: int, key: str, sent_at: Collection[int]) -> str:
    """The user's key if it made the call, unless the next call's mark needs the key's place."""
    taken = any(column in sent_at for column in range(sent + 1, sent + 1 + len(key)))
    return "" if call.caller or taken else key
