"""Draws belts: a name, the queue's level, the boxes up to the area's door, and the reason of their wait."""

from collections.abc import Sequence

from cbtui.looks.theme import GLYPHS, Ink, Role
from cbtui.widgets.factory.canvas import FAINT, PLAIN, STRONG, WARN, Canvas
from cbtui.widgets.factory.scene import Area, Belt, FactoryScene
from cbtui.widgets.factory.texts import belt_details, belt_name, first_fitting, queue_level, wait_texts
from cbtui.widgets.lanes.names import shortened
from sim.quantities.durations import duration
from sim.trace.events import EntityKind, GroupKind

_MOST_BOXES = 10
_LEAST_BOXES = 4
_TICK_TRACK = 6
_LONGEST_NAME = 18
_SHORTEST_NAME = 5


class BeltPainter:
    """Draws belts that end at the column ``door``, just before an area's wall."""

    def __init__(self, canvas: Canvas, scene: FactoryScene, door: int) -> None:
        self._canvas = canvas
        self._glyphs = canvas.glyphs
        self._scene = scene
        self._door = door
        every = [belt for area in scene.areas for belt in area.belts]
        longest = max((len(self._name_of(belt)) for belt in every), default=0)
        self._name = min(longest, _LONGEST_NAME, max(_SHORTEST_NAME, door * 2 // 5))
        self._level = max((len(_widest_level(belt)) for belt in every if belt.tick is None), default=0)

    def draw(self, belt: Belt, area: Area, line: int, rows: int) -> None:
        """Draw a belt in one row, where a timer's rate gives way to the reason of its wait, or in two.

        What is in no group has a name alone.
        """
        self._write_name(belt, line)
        if area.group.kind is GroupKind.NONE:  # an executor runs it as a task: nothing arrives
            return
        why = wait_texts(belt, self._scene.timeline, self._scene.now)
        at = self._level_or_rate(belt, line)
        room = self._door - at
        boxes = self._boxes(belt)
        if rows == 1:
            in_full, beside_boxes = why[:-3], room - min(boxes, _LEAST_BOXES) - 1
            text = first_fitting(in_full, beside_boxes) or first_fitting(in_full, room)
            rate_at = self._name + 2
            brief = "" if text or belt.tick is None else first_fitting(why[:-2], self._door - rate_at)
            if brief:
                text, at = brief.ljust(at - 1 - rate_at), rate_at
            text = text or first_fitting(why, room)
            at = self._say(text, line, at, _ink_of(belt))
            at, _ = self._details(belt, line, at, boxes)
        else:
            at, left_over = self._details(belt, line, at, boxes)
            self._below(why, _ink_of(belt), left_over, line + 1)
        self._track(belt, line, at, Ink(Role.BAR, area.number))
        self._draw_door(belt, line, Ink(Role.BAR, area.number))

    def more(self, hidden: int, line: int) -> None:
        """Show the number of belts that do not fit."""
        self._canvas.write(1, line, f"+{hidden} more belts", FAINT, self._door - 1)

    def _name_of(self, belt: Belt) -> str:
        return belt_name(belt, self._scene.timeline, self._canvas.charset)

    def _write_name(self, belt: Belt, line: int) -> None:
        name = self._name_of(belt)
        name = shortened(name, self._name, GLYPHS[self._canvas.charset].ellipsis, (name,))
        self._canvas.write(1, line, name, STRONG, self._name)

    def _level_or_rate(self, belt: Belt, line: int) -> int:
        """Write a belt's level, or a timer's rate; return the column after it."""
        at = self._name + 2
        if belt.tick is not None:
            text, ink = f"{self._glyphs.clock} {duration(belt.entity.period)}", PLAIN
            width = len(text)
        elif belt.mismatch and at + len(belt.mismatch) < self._door:
            text, ink, width = belt.mismatch, WARN, len(belt.mismatch)
        else:
            text = queue_level(belt)
            ink = WARN if belt.full else PLAIN if belt.queue.depth else FAINT
            width = self._level if self._door > 24 else len(text)
        self._canvas.write(at, line, text, ink, self._door - at)
        return min(self._door, at + width + 1)

    def _say(self, text: str, line: int, at: int, ink: Ink) -> int:
        """Write text and a blank; return the column after them."""
        return self._canvas.write(at, line, text, ink, self._door - at) + 1 if text else at

    def _details(self, belt: Belt, line: int, at: int, boxes: int) -> tuple[int, list[tuple[str, Ink]]]:
        """Write what fits before the boxes; return the column after it, and what did not fit.

        The number of lost messages may push boxes together, the rest may not.
        """
        left_over = []
        for text, warns in belt_details(belt, self._scene.now):
            ink = WARN if warns else FAINT
            least = min(boxes, _LEAST_BOXES) if warns else boxes
            if at + len(text) + 1 + least <= self._door:
                at = self._say(text, line, at, ink)
            else:
                left_over.append((text, ink))
        return at, left_over

    def _below(
        self, why: Sequence[str], ink_of_why: Ink, left_over: Sequence[tuple[str, Ink]], line: int
    ) -> None:
        """Write the reason at the door, and at the left what did not fit above."""
        text = first_fitting(why, self._door)
        start = self._door + 1 - len(text)
        self._canvas.write(start, line, text, ink_of_why, len(text))
        at = self._name + 2
        for other, ink in left_over:
            if at + len(other) + 1 <= start:
                at = self._say(other, line, at, ink)

    def _boxes(self, belt: Belt) -> int:
        """Return the preferred columns of a belt's boxes."""
        if belt.tick is not None:
            return 1 if belt.wait or belt.tick.is_cancelled else _TICK_TRACK
        return min(_MOST_BOXES, max(belt.entity.depth, 0) or _MOST_BOXES)

    def _track(self, belt: Belt, line: int, at: int, box: Ink) -> None:
        self._canvas.fill(at, self._door, line, self._glyphs.belt, FAINT)
        if belt.tick is not None:
            self._tick(belt, line, at, box)
            return
        cells = max(0, min(self._boxes(belt), self._door - at))
        ages = self._chips(belt, cells, self._door - at)
        end = self._door
        for age in ages:
            end -= len(age) + 2
            self._chip(age, line, end, box)
        cells = max(0, min(cells - len(ages), end - at))
        slots = max(1, (belt.entity.depth or cells) - len(ages))
        rest = max(0, belt.queue.depth - len(ages))
        filled = min(cells, -(-rest * cells // slots))
        self._canvas.fill(end - cells, end - filled, line, self._glyphs.slot, FAINT)
        self._canvas.fill(end - filled, end, line, self._glyphs.box, box)

    def _chips(self, belt: Belt, cells: int, room: int) -> list[str]:
        """Return the ages of the front messages that fit into their boxes."""
        ages: list[str] = []
        for message in belt.queue.messages[:_MOST_BOXES]:
            age = duration(max(0, message.age(self._scene.now))).replace(" ", "")
            room -= len(age) + 2
            if room < max(0, cells - len(ages) - 1):
                break
            ages.append(age)
        return ages

    def _chip(self, age: str, line: int, at: int, box: Ink) -> None:
        left, right = self._glyphs.seat
        self._canvas.put(at, line, left, box)
        self._canvas.write(at + 1, line, age, Ink(Role.LABEL, box.number), len(age))
        self._canvas.put(at + 1 + len(age), line, right, box)

    def _tick(self, belt: Belt, line: int, at: int, box: Ink) -> None:
        """Draw a timer's next tick on its way to the door."""
        way = self._door - at - 1
        if way < 0 or belt.tick is None:
            return
        if belt.wait is not None:
            self._canvas.put(self._door - 1, line, self._glyphs.tick, box)
        elif belt.tick.due is not None and belt.entity.period > 0:
            left = min(1.0, max(0, belt.tick.due - self._scene.now) / belt.entity.period)
            self._canvas.put(self._door - 1 - int(left * way), line, self._glyphs.tick, box)

    def _draw_door(self, belt: Belt, line: int, box: Ink) -> None:
        if belt.wait is not None:
            self._canvas.put(self._door, line, GLYPHS[self._canvas.charset].cross, _ink_of(belt))
        else:
            self._canvas.put(self._door, line, self._glyphs.door, box if belt.queue.depth else FAINT)


def _ink_of(belt: Belt) -> Ink:
    """Return the ink of a belt's wait: a warning, unless it waits only for its own last call."""
    return WARN if belt.waits_for_others else PLAIN


def _widest_level(belt: Belt) -> str:
    if belt.entity.kind is EntityKind.CLIENT:
        return max(queue_level(belt), "1 reply", key=len)
    return f"{belt.entity.depth}/{belt.entity.depth} !" if belt.entity.depth > 0 else queue_level(belt)
