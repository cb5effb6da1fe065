"""A screen as a terminal gets it: lines of text with colours between them, in files that ``cat`` shows."""

from collections.abc import Iterable, Iterator
from typing import NamedTuple

from rich.color import Color
from rich.segment import Segment
from rich.style import Style
from textual.app import App

_ON = {"bold": 1, "dim": 2, "italic": 3, "underline": 4, "reverse": 7, "strike": 9}
_OFF = {"bold": 22, "dim": 22, "italic": 23, "underline": 24, "reverse": 27, "strike": 29}
_SEEN_ON_BLANKS = {"underline", "reverse", "strike"}

_DEFAULT = Color.default()


class Look(NamedTuple):
    """What there is to see of a style: attributes, and the numbers that select both colours."""

    attributes: frozenset[str]
    ink: tuple[str, ...]
    paper: tuple[str, ...]


PLAIN = Look(frozenset(), ("39",), ("49",))


def ansi_of(app: App[None]) -> str:
    """Return what is on a console's screen; each line begins and ends plain."""
    return "".join(f"{line_of(strip)}\n" for strip in app.screen._compositor.render_strips())


def line_of(segments: Iterable[Segment]) -> str:
    """Return a line in which a style is only told where it changes."""
    return "".join(_pieces(segments))


def _pieces(segments: Iterable[Segment]) -> Iterator[str]:
    before = PLAIN
    for segment in segments:
        look = look_of(segment.style)
        if segment.text.isspace():
            look = _of_blanks(before, look)
        yield _change(before, look) + segment.text
        before = look
    if before != PLAIN:
        yield "\x1b[0m"


def _of_blanks(before: Look, look: Look) -> Look:
    """Return the look of blanks: where nothing is written, the ink stays as it was before."""
    if look.attributes & _SEEN_ON_BLANKS:
        return look
    return before._replace(attributes=before.attributes - _SEEN_ON_BLANKS, paper=look.paper)


def look_of(style: Style | None) -> Look:
    """Return what there is to see of a style; what it means and where it leads is left out."""
    if style is None:
        return PLAIN
    attributes = frozenset(name for name in _ON if getattr(style, name))
    ink, paper = style.color or _DEFAULT, style.bgcolor or _DEFAULT
    return Look(attributes, ink.get_ansi_codes(foreground=True), paper.get_ansi_codes(foreground=False))


def _change(before: Look, look: Look) -> str:
    ended = before.attributes - look.attributes
    off = {_OFF[name] for name in ended}
    # Bold and dim end together.
    on = {_ON[name] for name in look.attributes if name not in before.attributes or _OFF[name] in off}
    codes = [*map(str, sorted(off)), *map(str, sorted(on))]
    if look.ink != before.ink:
        codes += look.ink
    if look.paper != before.paper:
        codes += look.paper
    return f"\x1b[{';'.join(codes)}m" if codes else ""
