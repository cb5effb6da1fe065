"""Elements of an SVG picture for paper: colours, textures and shapes.

Colour is never the only sign: groups also have a texture and their letter, reasons of waits a hatching each.
"""

from dataclasses import dataclass

from sim.export.group_colours import group_colour
from sim.export.texts import xml
from sim.trace.events import Reason

TEXT = "#1C1C1C"
FAINT = "#6B7075"
RULE = "#D5D8DA"
WARN = "#B3200B"
FONT = "DejaVu Sans, Verdana, sans-serif"
FONT_SIZE = 11
CHARACTER = 6.7
"""The average width of a character at that size, in pixels, rounded up."""

_TEXTURES = (
    "",
    '<path d="M-1,1 l2,-2 M0,6 l6,-6 M5,7 l2,-2" stroke="{ink}" stroke-width="0.7"/>',
    '<circle cx="2" cy="2" r="0.9" fill="{ink}"/>',
    '<path d="M0,3 h6" stroke="{ink}" stroke-width="0.8"/>',
    '<path d="M3,0 v6" stroke="{ink}" stroke-width="0.8"/>',
    '<path d="M0,3 h6 M3,0 v6" stroke="{ink}" stroke-width="0.6"/>',
)
_RISING = "M-1,1 l2,-2 M0,7 l7,-7 M6,8 l2,-2"
_FALLING = "M-1,6 l2,2 M0,0 l7,7 M6,-1 l2,2"
_LEVEL = "M0,3.5 h7"
_HATCHES = {
    Reason.GROUP_HELD: ("group-held", _RISING),
    Reason.NO_FREE_WORKER: ("no-free-worker", _FALLING),
    Reason.EVENT_QUEUE: ("event-queue", _LEVEL),
    Reason.NOBODY_SPINS: ("nobody-spins", f"{_RISING} {_FALLING}"),
}


@dataclass(frozen=True, slots=True)
class Box:
    """A rectangle, in pixels."""

    x: float
    y: float
    width: float
    height: float


def definitions(groups: int) -> str:
    """The patterns of all groups and reasons."""
    patterns = [_group_pattern(number) for number in range(groups)]
    patterns += [
        f'<pattern id="{name}" width="7" height="7" patternUnits="userSpaceOnUse">'
        f'<rect width="7" height="7" fill="#FFFFFF"/>'
        f'<path d="{path}" stroke="{FAINT}" stroke-width="1"/></pattern>'
        for name, path in _HATCHES.values()
    ]
    return f"<defs>{''.join(patterns)}</defs>"


def bar(box: Box, number: int, about: str) -> str:
    """A call of a group's callback."""
    ink = group_colour(number)
    return (
        f'<rect {_place(box)} fill="url(#group-{number})" stroke="{ink}" stroke-width="0.8">'
        f"<title>{xml(about)}</title></rect>"
    )


def hatched(box: Box, reason: Reason, about: str) -> str:
    """A wait."""
    name, _ = _HATCHES[reason]
    return (
        f'<rect {_place(box)} fill="url(#{name})" stroke="{FAINT}" stroke-width="0.6" '
        f'stroke-dasharray="3 2"><title>{xml(about)}</title></rect>'
    )


def outline(box: Box, about: str) -> str:
    """A frame around a stretch of a lane."""
    shape = f'<rect {_place(box)} fill="none" stroke="{WARN}" stroke-width="1.6">'
    return f"{shape}<title>{xml(about)}</title></rect>"


def ground(box: Box) -> str:
    """The background of a lane."""
    return f'<rect {_place(box)} fill="#F6F7F8"/>'


def line(x1: float, y1: float, x2: float, y2: float, ink: str = RULE, width: float = 1) -> str:
    """A straight line."""
    return (
        f'<line x1="{x1:.2f}" y1="{y1:.2f}" x2="{x2:.2f}" y2="{y2:.2f}" stroke="{ink}" '
        f'stroke-width="{width:g}"/>'
    )


def words(x: float, y: float, text: str, ink: str = TEXT, anchor: str = "start", weight: str = "") -> str:
    """A line of text with its baseline at ``y``, readable on any texture."""
    bold = f' font-weight="{weight}"' if weight else ""
    return (
        f'<text x="{x:.2f}" y="{y:.2f}" fill="{ink}" text-anchor="{anchor}"{bold} stroke="#FFFFFF" '
        f'stroke-width="2.5" stroke-linejoin="round" paint-order="stroke">{xml(text)}</text>'
    )


def fitting(texts: tuple[str, ...], room: float) -> str:
    """The first of the texts that fits into a width in pixels; empty if none does."""
    return next((text for text in texts if len(text) * CHARACTER <= room), "")


def shortened(text: str, room: float) -> str:
    """The text, cut to a width in pixels."""
    most = max(1, int(room / CHARACTER))
    return text if len(text) <= most else text[: most - 1] + "…"


def _group_pattern(number: int) -> str:
    ink = group_colour(number)
    texture = _TEXTURES[number % len(_TEXTURES)].format(ink=ink)
    return (
        f'<pattern id="group-{number}" width="6" height="6" patternUnits="userSpaceOnUse">'
        f'<rect width="6" height="6" fill="#FFFFFF"/><rect width="6" height="6" fill="{ink}" '
        f'fill-opacity="0.16"/>{texture}</pattern>'
    )


def _place(box: Box) -> str:
    return f'x="{box.x:.2f}" y="{box.y:.2f}" width="{box.width:.2f}" height="{box.height:.2f}"'
