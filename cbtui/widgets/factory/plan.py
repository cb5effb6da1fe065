"""The layout of the factory: columns for belts, areas and workers, rows for each area."""

from collections.abc import Sequence
from dataclasses import dataclass

from cbtui.widgets.factory.scene import Area, FactoryScene
from cbtui.widgets.factory.texts import counts_text

LEAST_WIDTH = 30
LEAST_HEIGHT = 3
"""Columns and rows below which there is one sentence instead of a picture."""

_YARD_FROM = 104
_YARD = 28
_ROOMY = 60
_LEAST_AREA = 16
_AREA = 29
_AREA_BESIDE_YARD = 46
_HEADLINE_FROM = 7
_MOST_GAP = 2
_BENCH_FROM = 5


@dataclass(frozen=True, slots=True)
class FactoryColumns:
    """The columns of a picture from left to right; ``yard`` is the width of the workers' own column, or 0."""

    width: int
    belts: int
    area: int
    aisle: int
    yard: int

    @property
    def right_wall(self) -> int:
        """The column of an area's right wall; its left one stands at ``belts``."""
        return self.belts + self.area - 1

    @property
    def aisle_at(self) -> int:
        """The first column right of the areas."""
        return self.belts + self.area


def columns_for(width: int) -> FactoryColumns:
    """Return the columns for a width of ``LEAST_WIDTH`` or more."""
    yard = _YARD if width >= _YARD_FROM else 0
    aisle = 7 if yard else 5 if width >= _ROOMY else 3
    rest = width - yard - aisle
    share = rest // 2 if width < _ROOMY else rest * 46 // 100
    area = max(_LEAST_AREA, min(share, _AREA_BESIDE_YARD if yard else _AREA))
    return FactoryColumns(width, rest - area, area, aisle, yard)


@dataclass(frozen=True, slots=True)
class Density:
    """Rows per belt, and above and below each area; ``last`` below all of them."""

    belt: int
    top: int
    bottom: int
    last: int
    seat: int = 1

    def rows(self, area: Area, scene: FactoryScene) -> int:
        """Return the rows between an area's walls."""
        seats = min(max(len(scene.workers), 2), 4) if area.is_open and self.belt > 1 else 1
        return max(len(area.belts) * self.belt, seats * self.seat)

    def height(self, areas: Sequence[Area], scene: FactoryScene) -> int:
        """Return the rows of areas, with their walls."""
        return sum(self.top + self.rows(area, scene) + self.bottom for area in areas) + self.last


LARGE = Density(3, 1, 1, 0, seat=3)
"""Workers as figures of three rows, if they have a column of their own."""

DENSITIES = (LARGE, Density(2, 1, 1, 0), Density(2, 1, 0, 1), Density(1, 1, 0, 1), Density(1, 0, 0, 0))
"""From large figures to bare rows."""


@dataclass(frozen=True, slots=True)
class AreaPlacement:
    """The place of an area: its first row between the walls, how many there are, and the belts it shows."""

    area: Area
    first: int
    rows: int
    belts: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class FactoryPlan:
    """The arrangement of a picture. Rows that are None are not shown."""

    columns: FactoryColumns
    height: int
    density: Density
    places: tuple[AreaPlacement, ...]
    hidden: int
    headline: int | None
    captions: int | None
    bench: int | None


def plan_for(scene: FactoryScene, width: int, height: int) -> FactoryPlan:
    """Arrange a scene in at least ``LEAST_WIDTH`` x ``LEAST_HEIGHT``.

    The arrangement depends on who takes part, not on what they do, so that it does not move; only what is
    hidden for want of room changes.
    """
    columns = columns_for(width)
    bench = 0 if columns.yard or height < _BENCH_FROM else 1
    beside = len(counts_text(scene)) + 2 <= columns.belts
    own = 1 if height >= _HEADLINE_FROM else 0
    room = height - bench
    for density in DENSITIES if columns.yard else DENSITIES[1:]:
        before = 0 if beside and density.top else own
        if density.height(scene.areas, scene) + before <= room:
            return _arranged(scene, columns, height, density, scene.areas, before, bench)
    density = DENSITIES[-1]
    shown = _most_telling(scene, room - 1, density)
    return _arranged(scene, columns, height, density, shown, 1, bench)


def _most_telling(scene: FactoryScene, room: int, density: Density) -> Sequence[Area]:
    """Return as many areas as fit, those with waiting or running callbacks first; at least one."""
    worths = {area.group.id: _worth(area) for area in scene.areas}
    left, chosen = room, set[int]()
    for area in sorted(scene.areas, key=lambda each: -worths[each.group.id]):
        rows = density.rows(area, scene)
        if rows <= left or not chosen:
            chosen.add(area.group.id)
            left -= rows
    return [area for area in scene.areas if area.group.id in chosen]


def _worth(area: Area) -> int:
    if area.waiting:
        return 4
    if area.inside or area.kept:
        return 3
    return 2 if area.visitors else 1 if any(belt.queue.depth for belt in area.belts) else 0


def _arranged(
    scene: FactoryScene,
    columns: FactoryColumns,
    height: int,
    density: Density,
    areas: Sequence[Area],
    before: int,
    bench: int,
) -> FactoryPlan:
    spare = height - bench - before - density.height(areas, scene)
    if spare > 0 and not before:
        before, spare = 1, spare - 1
    captions = 1 if spare > 0 and before and density.top and areas else 0
    at = before + captions
    gap = min(_MOST_GAP, (spare - captions) // max(1, len(areas))) if density is LARGE else 0
    places = []
    for area in areas:
        rows = max(1, min(density.rows(area, scene), height - bench - at))
        at += density.top
        places.append(AreaPlacement(area, at, rows, _belts_shown(area, rows // density.belt)))
        at += rows + density.bottom + max(0, gap)
    at += density.last
    bench_at = min(height - 1, at + (1 if height - 1 - at >= 1 else 0))
    return FactoryPlan(
        columns,
        height,
        density,
        tuple(places),
        hidden=len(scene.areas) - len(areas) + scene.more,
        headline=0 if before or (density.top and areas) else None,
        captions=before if captions else None,
        bench=bench_at if bench else None,
    )


def _belts_shown(area: Area, room: int) -> tuple[int, ...]:
    """Return the places of the belts that fit: those that wait, run or hold something first.

    If some are hidden, a row shows their number, unless there is only one row.
    """
    every = range(len(area.belts))
    running = {worker.span.entity for worker in area.visitors if worker.span and worker.inside}
    if len(every) <= room:
        return tuple(every)

    def worth(place: int) -> tuple[bool, bool, int]:
        belt = area.belts[place]
        return belt.wait is not None, belt.entity.id in running, belt.queue.depth

    ranked = sorted(every, key=worth, reverse=True)
    return tuple(sorted(ranked[: max(1, room - 1)]))
