"""A scrolling view that draws its visible lines in inks and component classes."""

from collections.abc import Sequence
from dataclasses import dataclass

from rich.color import Color
from rich.segment import Segment
from rich.style import Style
from textual.message import Message
from textual.scroll_view import ScrollView
from textual.strip import Strip

from cbtui.looks.colour_themes import palette_of
from cbtui.looks.contrast import legible
from cbtui.looks.theme import GLYPHS, Charset, Ink, Role, style_of
from sim.quantities.plural import counted
from sim.trace.model import Nanoseconds


class InkedView(ScrollView):
    """A scroll view that caches the styles of its lines until the theme changes."""

    ALLOW_SELECT = False

    @dataclass
    class MomentPicked(Message):
        """The user picked a line about the moment ``at``, in nanoseconds of the run; None if it has none."""

        at: Nanoseconds | None

    def __init__(self, *, id: str | None = None) -> None:  # noqa: A002 Textual's name for it
        super().__init__(id=id)
        self._inks: dict[Ink, Style] = {}
        self._classes_drawn: dict[str, Style] = {}

    def notify_style_update(self) -> None:
        """Discard the styles of the previous theme."""
        super().notify_style_update()
        self._inks.clear()
        self._classes_drawn.clear()

    def in_ink(self, ink: Ink) -> Style:
        """Return the style of an ink on the view's background."""
        if ink not in self._inks:
            ground = self.background_colors[1].hex6.lower()
            self._inks[ink] = style_of(ink, palette_of(self.app.current_theme), ground)
        return self._inks[ink]

    def in_class(self, component: str) -> Style:
        """Return the style of a component class; "" is the view's own."""
        if component not in self._classes_drawn:
            style = self.get_component_rich_style(component) if component else self.rich_style
            self._classes_drawn[component] = style
        return self._classes_drawn[component]

    def cut(self, line: Strip, left: int, width: int) -> Strip:
        """Return a line from a column on, with an ellipsis where it goes on beyond ``width`` columns."""
        if line.cell_length <= left + width:
            return line.crop(left, left + width)
        ellipsis = Segment(GLYPHS[Charset.BRAILLE].ellipsis, self.in_ink(Ink(Role.FAINT)))
        shown = line.crop(left, left + width - 1).adjust_cell_length(width - 1, self.in_class(""))
        return Strip([*shown, ellipsis], width)

    def set_off(self, line: Strip, component: str) -> Strip:
        """Return a line with a component's background where it has none of its own."""
        usual, bold = self.in_class("").bgcolor, Style(bold=True)
        parts = [
            Segment(text, self.on_ground(style, component) + bold)
            if style and style.bgcolor == usual
            else Segment(text, style)
            for text, style, _ in line
        ]
        return Strip(parts, line.cell_length)

    def on_ground(self, style: Style, component: str) -> Style:
        """Return a style on a component's background, its colour moved until it is readable there."""
        ground = self.in_class(component).bgcolor
        if ground is None or ground.is_default or style.color is None or style.color.is_default:
            return style + Style(bgcolor=ground)
        least = palette_of(self.app.current_theme).words
        colour = legible(style.color.get_truecolor(), ground.get_truecolor(), least)
        return style + Style(color=Color.from_triplet(colour), bgcolor=ground)

    def copy(self, lines: Sequence[str]) -> None:
        """Copy lines to the terminal's clipboard (OSC 52, which works over ssh), and report their number."""
        if lines:
            self.app.copy_to_clipboard("\n".join(lines))
            self.notify(f"copied {counted(len(lines), 'line')}")
