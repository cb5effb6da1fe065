"""Draws areas: their walls, the sign on the upper one, and the seats inside."""

from dataclasses import dataclass

from cbtui.looks.theme import GLYPHS, Ink, Role, texture_of
from cbtui.widgets.factory.canvas import PLAIN, WARN, Canvas
from cbtui.widgets.factory.glyphs import Walls
from cbtui.widgets.factory.large_seats import LargeSeatPainter
from cbtui.widgets.factory.plan import LARGE, AreaPlacement, Density, FactoryColumns
from cbtui.widgets.factory.scene import Area, FactoryScene
from cbtui.widgets.factory.seats import SeatPainter
from cbtui.widgets.factory.texts import admission_texts, first_fitting

_SWATCH = 2
"""Columns of a group's texture beside its letter, as in the lanes."""
_LONGEST_QUEUE = len("  1 waits ")


@dataclass(frozen=True, slots=True)
class AreaPainter:
    """Draws areas."""

    canvas: Canvas
    scene: FactoryScene
    columns: FactoryColumns

    def top(self, area: Area, line: int, joined: bool) -> None:
        """Draw the upper wall with the group's letter and its seats; ``joined`` to the area above."""
        walls = self._walls(area)
        left, right = (walls.left_joint, walls.right_joint) if joined else (walls.top_left, walls.top_right)
        self._wall(area, line, left, right)
        at, end = self.columns.belts + 2, self.columns.right_wall
        at = self.canvas.write(at, line, f" {area.group.letter}", Ink(Role.LETTER, area.number), end - at)
        at = self._texture(area, at, line, end)
        seats, kept = admission_texts(area), _LONGEST_QUEUE if area.waiting else 0
        crewed = [f" {text} " for text in (f"{seats[0]}, {area.crew}", area.crew)] if area.crew else []
        text = first_fitting(crewed, end - at - 1 - kept)
        text = text or first_fitting([f" {each} " for each in seats], end - at - 1)
        at = self.canvas.write(at, line, text, PLAIN, len(text))
        if area.waiting:
            ways = ("waits outside", "waits") if area.waiting == 1 else ("wait outside", "wait")
            text = first_fitting([f" {area.waiting} {words} " for words in ways], end - at - 2)
            self.canvas.write(end - 1 - len(text), line, text, WARN, len(text))

    def _texture(self, area: Area, at: int, line: int, end: int) -> int:
        """Draw the group's texture if every word still fits; return the column after it."""
        words = max(len(f" {admission_texts(each)[0]} ") for each in self.scene.areas)
        if end - at - 1 < 1 + _SWATCH + words + _LONGEST_QUEUE:
            return at
        texture = texture_of(area.number, GLYPHS[self.canvas.charset])
        at = self.canvas.write(at, line, " ", PLAIN, 1)
        return self.canvas.write(at, line, texture.text * _SWATCH, texture.ink, _SWATCH)

    def bottom(self, area: Area, line: int) -> None:
        """Draw the lower wall."""
        walls = self._walls(area)
        self._wall(area, line, walls.bottom_left, walls.bottom_right)

    def inner(self, place: AreaPlacement, density: Density) -> None:
        """Draw side walls, seats and workers, and the group's letter if there is no upper wall."""
        area, ink = place.area, Ink(Role.LINE, place.area.number)
        for line in range(place.first, place.first + place.rows):
            self.canvas.put(self.columns.belts, line, self._walls(area).side, ink)
            self.canvas.put(self.columns.right_wall, line, self._walls(area).side, ink)
        at = self.columns.belts + 1
        if not density.top:
            at = self.canvas.write(at, place.first, area.group.letter, Ink(Role.LETTER, area.number), 3)
        seats = LargeSeatPainter if density is LARGE else SeatPainter
        seats(self.canvas, self.scene, place, self.columns, at).draw()

    def _walls(self, area: Area) -> Walls:
        return self.canvas.glyphs.open if area.is_open else self.canvas.glyphs.walled

    def _wall(self, area: Area, line: int, left: str, right: str) -> None:
        ink = Ink(Role.LINE, area.number)
        start, end = self.columns.belts, self.columns.right_wall
        self.canvas.fill(start + 1, end, line, self._walls(area).top, ink)
        self.canvas.put(start, line, left, ink)
        self.canvas.put(end, line, right, ink)
