"""The sizes of lanes and panes, which the user changes and which are remembered."""

from collections.abc import Callable
from dataclasses import dataclass
from math import ceil
from typing import Annotated

from msgspec import Meta, Struct, ValidationError, convert, to_builtins

from cbtui.screens.layout import GRID_FROM, Layout
from cbtui.screens.parts.panes import LANES_ALONE, PANE_ALONE, WITHOUT_ROBOT, PaneLayout
from cbtui.screens.parts.part import ScreenPart
from cbtui.screens.sized import SizedScreen
from cbtui.widgets.lanes import Lanes
from cbtui.widgets.narrator.narrator import ROWS, Narrator
from cbtui.widgets.robot import RobotView
from lessons.personal import state_folder
from lessons.state_file import StateFile, StateFileTexts

_WORDS = StateFileTexts("size of panes", "sizes of panes are not remembered", "sizes go on")
_ACROSS, _DOWN = 24, 14
"""The units of the grid's width and height."""
_LEAST_ACROSS, _LEAST_DOWN = 4, 3
_LANES_LEAST, _LANES_MOST = 12, 75
"""Per cent of the screen's height."""
_SCENE_LEAST = 34
"""Columns of a scene's pane in which its names and most of its reasons have room."""
_WIDE_FROM = 160
"""Columns of a screen from which the code has more of them than the scene."""
_LANES_ROWS = 5
"""Rows that the lanes keep, be it beside the narrator."""

_Third = Annotated[int, Meta(ge=_LEAST_ACROSS, le=_ACROSS - 2 * _LEAST_ACROSS)]


class PaneSizes(Struct, frozen=True):
    """The sizes in a layout: per cent of the height that the lanes get at most, and units of the grid.

    ``left`` is the width of guide, checks and choice, ``right`` of the robot, ``bottom`` of the factory; code
    and log have what is left. ``top`` is the height of the upper panes.
    """

    layout: Layout
    lanes: Annotated[int, Meta(ge=_LANES_LEAST, le=_LANES_MOST)] = 45
    left: _Third = 8
    right: _Third = 8
    bottom: Annotated[int, Meta(ge=_LEAST_ACROSS, le=_ACROSS - _LEAST_ACROSS)] = 12
    top: Annotated[int, Meta(ge=_LEAST_DOWN, le=_DOWN - _LEAST_DOWN)] = 8

    def __post_init__(self) -> None:
        if self.left + self.right > _ACROSS - _LEAST_ACROSS:
            raise ValueError("no room is left for the code")


_WIDTHS = {
    "guide": ("left", 1),
    "checks": ("left", 1),
    "choice": ("left", 1),
    "code": ("right", -1),
    "robot": ("right", 1),
    "factory": ("bottom", 1),
    "log": ("bottom", -1),
    "shell": ("bottom", -1),
}
"""The size that each pane's width depends on, and in which direction."""
_UPPER = ("guide", "checks", "choice", "code", "robot")


@dataclass
class SizeKeys(ScreenPart):
    """Gives the pane with the focus, or the lanes, more or less room, and remembers that."""

    screen: SizedScreen[None]
    panes: PaneLayout
    tell: Callable[[str], None]

    def __post_init__(self) -> None:
        self._file = StateFile(state_folder() / "sizes.jsonl", PaneSizes, _WORDS)
        content = self._file.read()
        self.panes.arranged = self.apply
        self._kept = {} if content is None else {each.layout: each for each in content.entries}

    def apply(self) -> None:
        """Give the panes their sizes; to be called when the layout or the shown panes have changed."""
        sizes, screen, alone = self._sizes, self.screen, self.screen.has_class(LANES_ALONE)
        height = max(_LANES_ROWS, self._height * sizes.lanes // 100 - self._narrated)
        screen.query_one(Lanes).styles.max_height = "100%" if alone else height
        screen.query_one("#panes").styles.grid_rows = f"{sizes.top}fr {_DOWN - sizes.top}fr"
        spans = {"left": sizes.left, "right": sizes.right, "bottom": sizes.bottom}
        for name in self.panes.names:
            side, sign = _WIDTHS[name]
            self.panes.pane(name).styles.column_span = spans[side] if sign > 0 else _ACROSS - spans[side]
        right = sizes.right if self._has_robot else 0
        self.panes.pane("code").styles.column_span = _ACROSS - sizes.left - right

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer the keys that have an effect."""
        if action == "usual_sizes":
            return self._chosen is not None
        if action == "no_size":
            return self._changed(str(parameters[0])) is None
        return self._changed(action) is not None

    def action_wider(self) -> None:
        """Give the pane more columns."""
        self._take(self._changed("wider"))

    def action_narrower(self) -> None:
        """Give the pane fewer columns."""
        self._take(self._changed("narrower"))

    def action_taller(self) -> None:
        """Give the pane, or the lanes, more rows."""
        self._take(self._changed("taller"))

    def action_lower(self) -> None:
        """Give the pane, or the lanes, fewer rows."""
        self._take(self._changed("lower"))

    def action_usual_sizes(self) -> None:
        """Give everything its usual size."""
        self._take(PaneSizes(self.screen.layout_now))

    def action_no_size(self, wanted: str) -> None:
        """Say why the size stays."""
        self.tell(self._why_not(wanted))

    def _why_not(self, wanted: str) -> str:
        screen, lanes = self.screen, self.screen.query_one(Lanes)
        on_lanes, is_grid = lanes.has_focus, screen.layout_now is Layout.GRID
        if screen.has_class(LANES_ALONE) or screen.has_class(PANE_ALONE):
            return "What fills the screen has no other size."
        if wanted in ("wider", "narrower") and (on_lanes or not is_grid):
            small = f"In a terminal below {GRID_FROM.width} × {GRID_FROM.height} a pane has"
            return f"{'The lanes have' if on_lanes else small} the whole width."
        if lanes.shows_everything and (wanted == "taller") is on_lanes and (on_lanes or not is_grid):
            return "The lanes are all on screen: they need no more rows."
        return f"It gets no {wanted}: that is the limit."

    @property
    def _chosen(self) -> PaneSizes | None:
        """The sizes that the user has given; None for the usual ones."""
        usual = PaneSizes(self.screen.layout_now)
        kept = self._kept.get(usual.layout, usual)
        return None if kept == usual else kept

    @property
    def _sizes(self) -> PaneSizes:
        """The sizes in force; on a wide screen, or while it is read, the code has room for longer lines."""
        if self._chosen is not None:
            return self._chosen
        usual, columns = PaneSizes(self.screen.layout_now), self.screen.app.size.width
        is_read = self.panes.current == "code"
        if not self._has_robot or not (is_read or columns >= _WIDE_FROM):
            return usual
        is_plain = is_read and not self.screen.query_one(RobotView).actors
        right = 0 if is_plain else ceil(_ACROSS * _SCENE_LEAST / max(1, columns))
        left = 6 if is_read else usual.left
        return PaneSizes(usual.layout, left=left, right=max(5, min(right, usual.right)))

    @property
    def _height(self) -> int:
        """The rows of the screen above its keys."""
        return max(1, self.screen.app.size.height - 1)

    @property
    def _narrated(self) -> int:
        """The rows that lanes give to the narrator where there are few, so that the pane keeps its own."""
        is_shown = self.screen.query_one(Narrator).display and self.screen.layout_now is Layout.TABBED
        return ROWS if is_shown else 0

    @property
    def _has_robot(self) -> bool:
        return self.panes.current == "robot" or not self.screen.has_class(WITHOUT_ROBOT)

    def _changed(self, action: str) -> PaneSizes | None:
        """The sizes after one of the keys; None if there is no room, or no pane that can be sized."""
        sizes, step = self._sizes, 1 if action in ("wider", "taller") else -1
        lanes, current, is_grid = (
            self.screen.query_one(Lanes),
            self.panes.current,
            sizes.layout is Layout.GRID,
        )
        if self.screen.has_class(LANES_ALONE) or self.screen.has_class(PANE_ALONE):
            return None
        if action in ("wider", "narrower"):
            if lanes.has_focus or not is_grid:
                return None
            side, sign = ("left", -1) if current == "code" and not self._has_robot else _WIDTHS[current]
            value = getattr(sizes, side) + sign * step
        elif is_grid and not lanes.has_focus:
            side, value = "top", sizes.top + (step if current in _UPPER else -step)
        else:
            rows = step if lanes.has_focus else -step
            if lanes.shows_everything if rows > 0 else lanes.outer_size.height <= _LANES_ROWS:
                return None
            height = lanes.outer_size.height + self._narrated + rows
            side, value = "lanes", ceil(100 * height / self._height)
        try:
            return convert(to_builtins(sizes) | {side: value}, PaneSizes)
        except ValidationError:
            return None

    def _take(self, sizes: PaneSizes | None) -> None:
        if sizes is None:
            return
        self._kept[sizes.layout] = sizes
        with self._file.lock():
            self._file.write(self._kept.values())
        for trouble in self._file.troubles():
            self.tell(trouble)
        self.apply()
