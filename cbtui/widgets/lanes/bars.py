"""What lanes look like between label and status: bars, lines, hatching and the words on them."""

from collections.abc import Sequence
from dataclasses import dataclass

from cbtui.theme import GLYPHS, Glyphs, Ink, Role
from cbtui.widgets.cells import Row
from cbtui.widgets.durations import duration
from cbtui.widgets.lanes.columns import Column, Stretch, stretches
from cbtui.widgets.lanes.status import is_late, short
from sim.trace.events import EntityId, EntityKind, GroupKind, Reason
from sim.trace.model import Entity, Group, Nanoseconds, Span, Wait
from sim.trace.timeline import Timeline

_WAIT_SHOWS_FROM = 2
"""Eighths of a column: shorter waits beside calls are not worth hatching."""

_WORDS = Ink(Role.STRONG)
_WARN = Ink(Role.WARN)


@dataclass(frozen=True, slots=True)
class Bars:
    """Draws calls and waits into rows. ``now`` is the cursor's time; ``numbers`` the place of each group."""

    timeline: Timeline
    glyphs: Glyphs
    now: Nanoseconds
    numbers: dict[int, int]

    def thread(self, row: Row, columns: Sequence[Column[Span] | None]) -> None:
        """Draw a thread's calls: bars with the group's letter and the callback's name, ticks for short ones."""
        for stretch in stretches(columns):
            number = self._number(stretch.top.entity)
            self._columns(row, stretch, Ink(Role.BAR, number))
            self._seam(row, stretch)
            self._label(row, stretch, Ink(Role.LABEL, number))
            self._failure(row, stretch)

    def group(self, row: Row, columns: Sequence[Column[Span] | None], group: Group) -> None:
        """Draw who holds a group: a line for as long as it is held, a point for an instant."""
        ink = Ink(Role.LINE, self.numbers[group.id])
        if group.kind is GroupKind.REENTRANT:
            self._together(row, columns, ink)
            return
        for stretch in stretches(columns):
            if len(stretch.columns) == 1:
                row.put(stretch.first, self.glyphs.point, ink)
                continue
            row.fill(stretch.first, stretch.after, self.glyphs.line, ink)
            callback = self.timeline.entities[stretch.top.entity].callback
            thread = self.timeline.threads[stretch.top.thread].name
            texts = (
                f"held by {callback} on {short_thread(thread)}",
                f"held by {callback}",
                f"by {short(callback)}",
            )
            self._words(row, stretch.first, stretch.after, texts)

    def _together(self, row: Row, columns: Sequence[Column[Span] | None], ink: Ink) -> None:
        """Draw a group that lets everyone in: a line where one runs, a double one where several do."""
        for place, column in enumerate(columns):
            if column is not None and column.at_once > 1:
                row.put(place, self.glyphs.double_line, ink)
            elif column is not None:
                row.put(place, self.glyphs.line if column.at_once else self.glyphs.point, ink)
        for first, after, most in _crowds(columns):
            self._words(row, first, after, (f"{most} at once",))

    def calls(self, row: Row, columns: Sequence[Column[Span] | None], entity: Entity) -> None:
        """Draw when a callback runs: a mark for a short call, a line with its thread for a long one."""
        number = self._number(entity.id)
        late = []
        for stretch in stretches(columns):
            if len(stretch.columns) < 3:
                self._columns(row, stretch, Ink(Role.BAR, number))
            else:
                row.fill(stretch.first, stretch.after, self.glyphs.line, Ink(Role.LINE, number))
                span = stretch.top
                took = duration(span.end_at(self.now) - span.start)
                thread = short_thread(self.timeline.threads[span.thread].name)
                texts = (f"runs {took} on {thread}", f"runs {took}", "runs")
                self._words(row, stretch.first, stretch.after, texts)
            self._failure(row, stretch)
            if entity.kind is EntityKind.TIMER and is_late(stretch.top, entity):
                late.append(stretch)
        for stretch in late:
            self._late(row, stretch)

    def waits(
        self, row: Row, columns: Sequence[Column[Wait] | None], calls: Sequence[Column[Span] | None]
    ) -> None:
        """Draw when a callback waits: hatching, and the reason in words."""
        number = -1
        for stretch in stretches(columns):
            number = self._number(stretch.top.entity)
            hatch = self.glyphs.hatch[stretch.top.reason]
            shown = [
                place
                for place, column in enumerate(stretch.columns, stretch.first)
                if _wins(column, calls[place])
            ]
            for place in shown:
                row.put(place, hatch, Ink(Role.HATCH, number))
            if len(shown) > 3:
                self._words(row, shown[0] + 1, shown[-1] + 1, self._reasons(stretch.top))

    def _reasons(self, wait: Wait) -> tuple[str, ...]:
        """Return ways to say why a callback waits, from the fullest to the shortest."""
        lasts = wait.end is None or wait.end > self.now
        took = duration((self.now if lasts else wait.end or self.now) - wait.start)
        verb = "waits" if lasts else "waited"
        reason, *shorter = self._words_of(wait)
        return (
            f"{verb} {took}: {reason}",
            *(f"{verb} {took}: {one}" for one in shorter),
            f"{verb} {took}",
            took,
        )

    def _words_of(self, wait: Wait) -> tuple[str, ...]:
        if wait.reason is not Reason.GROUP_HELD:
            return (wait.reason.value,)
        if wait.holder == wait.entity:
            return ("its last call still runs", "still runs")
        letter = self.timeline.groups[self.timeline.entities[wait.entity].group].letter
        if wait.holder not in self.timeline.entities:
            return (f"{letter} held",)
        callback = self.timeline.entities[wait.holder].callback
        return (f"{letter} held by {callback}", f"{letter} held by {short(callback)}", f"{letter} held")

    def _columns(self, row: Row, stretch: Stretch[Span], ink: Ink) -> None:
        for place, column in enumerate(stretch.columns, stretch.first):
            side = self.glyphs.right if column.ends_right else self.glyphs.left
            row.put(place, side[column.eighths], ink)

    def _seam(self, row: Row, stretch: Stretch[Span]) -> None:
        """Part a bar from the one that it follows at once."""
        before = stretch.first - 1
        if len(stretch.columns) > 1 and before >= 0 and row.cells[before] == self.glyphs.left[8]:
            row.cells[before] = self.glyphs.left[7]

    def _label(self, row: Row, stretch: Stretch[Span], ink: Ink) -> None:
        whole = [place for place, column in enumerate(stretch.columns, stretch.first) if column.eighths == 8]
        if len(whole) < 2:
            return
        entity = self.timeline.entities[stretch.top.entity]
        letter = self.timeline.groups[entity.group].letter
        for text in (f"{letter} {entity.callback}", f"{letter} {short(entity.callback)}", letter):
            if len(text) + 1 <= len(whole):
                row.write(whole[0], f"{text} ", ink)
                return

    def _failure(self, row: Row, stretch: Stretch[Span]) -> None:
        if stretch.top.error:
            row.put(stretch.after - 1, self.glyphs.cross, _WARN)

    def _late(self, row: Row, stretch: Stretch[Span]) -> None:
        after = stretch.after
        for text in (f"late {duration(stretch.top.age)}", "late", "!"):
            if row.blank(after, after + len(text)):
                row.write(after, text, _WARN)
                return

    def _words(self, row: Row, first: int, after: int, texts: Sequence[str]) -> None:
        """Write the first of the texts that fits between two columns, with room around it."""
        for text in texts:
            if len(text) + 4 <= after - first:
                row.write(first + 1, f" {text} ", _WORDS)
                return

    def _number(self, entity: EntityId) -> int:
        return self.numbers[self.timeline.entities[entity].group]


def short_thread(name: str) -> str:
    """Return a thread's name with the pool's long class name cut to ``Pool``."""
    return name.replace("ThreadPoolExecutor", "Pool", 1)


def _wins(wait: Column[Wait], call: Column[Span] | None) -> bool:
    """Tell whether a column shows the wait: it took more than the calls, and enough to be seen."""
    if call is None:
        return True
    return wait.eighths >= _WAIT_SHOWS_FROM and wait.eighths > call.eighths


def _crowds(columns: Sequence[Column[Span] | None]) -> list[tuple[int, int, int]]:
    """Return stretches of columns in which several ran at once: first, after, and how many at most."""
    crowds: list[tuple[int, int, int]] = []
    for place, column in enumerate(columns):
        if column is None or column.at_once < 2:
            continue
        if crowds and crowds[-1][1] == place:
            first, _, most = crowds[-1]
            crowds[-1] = (first, place + 1, max(most, column.at_once))
        else:
            crowds.append((place, place + 1, column.at_once))
    return crowds
