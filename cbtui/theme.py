"""What things look like: colours of callback groups, textures of waits, and the glyphs of each charset."""

from dataclasses import dataclass
from enum import Enum, StrEnum, auto
from functools import lru_cache
from typing import NamedTuple

from rich.color import Color, blend_rgb
from rich.color_triplet import ColorTriplet
from rich.style import Style

from sim.trace.events import Reason


class Charset(StrEnum):
    """Which glyphs the terminal can show."""

    BRAILLE = "braille"
    BLOCK = "block"
    ASCII = "ascii"


class Role(Enum):
    """What a piece of a picture stands for; the palette decides how it looks."""

    TEXT = auto()
    FAINT = auto()
    STRONG = auto()
    LETTER = auto()
    BAR = auto()
    LABEL = auto()
    LINE = auto()
    HATCH = auto()
    WARN = auto()
    MARK = auto()
    NOW = auto()
    WALL = auto()
    SPHERE = auto()
    ROBOT = auto()
    TRAIL = auto()
    TRUE_SCAN = auto()
    SEEN_SCAN = auto()


class Ink(NamedTuple):
    """How a run of text is to look.

    ``number`` is the place of a callback group (0 for A) for the roles that show one, and the age step
    for ``TRAIL`` (0 the oldest). ``later`` marks what lies after the cursor.
    """

    role: Role
    number: int = -1
    later: bool = False


class Run(NamedTuple):
    """Text in one ink."""

    text: str
    ink: Ink


TRAIL_STEPS = 4
"""Into how many ages the robot's trail is divided."""


@dataclass(frozen=True)
class Palette:
    """Colours for one background. Groups beyond ``groups`` get ``other`` and are told by their letter."""

    groups: tuple[str, ...]
    other: str
    text: str
    faint: str
    warn: str
    mark: str
    now: str
    wall: str
    sphere: str
    robot: str
    trail: str
    true_scan: str
    seen_scan: str


DARK = Palette(
    groups=("#56B4E9", "#E69F00", "#009E73", "#F0E442", "#CC79A7", "#D55E00"),
    other="#B0B0B0",
    text="#E4E4E4",
    faint="#7C8790",
    warn="#FF8A6A",
    mark="#FFFFFF",
    now="#FFFFFF",
    wall="#8A949C",
    sphere="#F0E442",
    robot="#FFFFFF",
    trail="#CC79A7",
    true_scan="#56B4E9",
    seen_scan="#E69F00",
)
LIGHT = Palette(
    groups=("#040457", "#570404", "#278686", "#C63DF4", "#F2460C"),
    other="#5A5A5A",
    text="#1C1C1C",
    faint="#6B7075",
    warn="#B3200B",
    mark="#000000",
    now="#000000",
    wall="#6B7075",
    sphere="#8A6A00",
    robot="#000000",
    trail="#C63DF4",
    true_scan="#1F5FA8",
    seen_scan="#D2450A",
)


@dataclass(frozen=True)
class Glyphs:
    """The signs of one charset. ``left`` and ``right`` are a column filled from that side, by eighths."""

    left: str
    right: str
    line: str
    double_line: str
    point: str
    hatch: dict[Reason, str]
    frame: str
    cursor: str
    up: str
    back: str
    now: str
    ellipsis: str
    degree: str
    cross: str
    between: str


_BLOCKS = Glyphs(
    left=" ▎▎▍▌▋▊▉█",
    right=" ▕▕▐▐▐▐██",
    line="─",
    double_line="═",
    point="·",
    hatch={
        Reason.GROUP_HELD: "\N{BOX DRAWINGS LIGHT DIAGONAL UPPER RIGHT TO LOWER LEFT}",
        Reason.NO_FREE_WORKER: "\N{BOX DRAWINGS LIGHT DIAGONAL UPPER LEFT TO LOWER RIGHT}",
        Reason.NOBODY_SPINS: "\N{BOX DRAWINGS LIGHT DIAGONAL CROSS}",
    },
    frame="│",
    cursor="┊",
    up="▲",
    back="◂",
    now="▲",
    ellipsis="…",
    degree="°",
    cross="✗",
    between="·",
)
_PLAIN = Glyphs(
    left=" ||||####",
    right=" ||||####",
    line="-",
    double_line="=",
    point=".",
    hatch={Reason.GROUP_HELD: "/", Reason.NO_FREE_WORKER: "\\", Reason.NOBODY_SPINS: "x"},
    frame="|",
    cursor=":",
    up="^",
    back="<",
    now="^",
    ellipsis="~",
    degree=" deg",
    cross="X",
    between="-",
)
GLYPHS = {Charset.BRAILLE: _BLOCKS, Charset.BLOCK: _BLOCKS, Charset.ASCII: _PLAIN}


def group_colour(number: int, palette: Palette) -> str:
    """Return the colour of the group at a place in the order of letters (0 for A), as ``#RRGGBB``."""
    return palette.groups[number] if 0 <= number < len(palette.groups) else palette.other


@lru_cache(maxsize=2048)
def style_of(ink: Ink, dark: bool, background: str) -> Style:
    """Return the Rich style of an ink on a background (``#RRGGBB``)."""
    palette = DARK if dark else LIGHT
    ground = _triplet(background)
    colour = _triplet(_colour(ink, palette))
    if ink.role is Role.TRAIL:
        colour = blend_rgb(ground, colour, 0.4 + 0.6 * ink.number / (TRAIL_STEPS - 1))
    if ink.later:
        colour = blend_rgb(colour, ground, 0.55)
    if ink.role is Role.LABEL:
        return Style(color=Color.from_triplet(_readable_on(colour)), bgcolor=Color.from_triplet(colour))
    return Style(
        color=Color.from_triplet(colour),
        bgcolor=Color.from_triplet(ground),
        bold=ink.role in _BOLD,
    )


_BOLD = {Role.STRONG, Role.LETTER, Role.WARN, Role.MARK, Role.NOW, Role.ROBOT}
_OF_A_GROUP = {Role.LETTER, Role.BAR, Role.LABEL, Role.LINE, Role.HATCH}


def _colour(ink: Ink, palette: Palette) -> str:
    if ink.role in _OF_A_GROUP:
        return group_colour(ink.number, palette)
    if ink.role is Role.STRONG:
        return palette.text
    colour: str = getattr(palette, ink.role.name.lower())
    return colour


def _triplet(colour: str) -> ColorTriplet:
    return Color.parse(colour).get_truecolor()


def _readable_on(ground: ColorTriplet) -> ColorTriplet:
    """Return black or white, whichever contrasts more, by WCAG 2's relative luminance."""
    shares = (part / 255 for part in ground)
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in shares]
    luminance = 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
    return ColorTriplet(0, 0, 0) if luminance > 0.179 else ColorTriplet(255, 255, 255)
