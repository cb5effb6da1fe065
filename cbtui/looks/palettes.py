"""The colours of pictures: callback groups and all other roles, one palette per theme."""

from dataclasses import dataclass

from sim.export.group_colours import GROUP_COLOURS, OTHER_COLOUR


@dataclass(frozen=True, eq=False)
class Palette:
    """Colours for one background. Groups beyond ``groups`` share ``other``.

    ``words`` and ``shapes`` are the least contrasts (WCAG 2, 1 to 21) of text and of shapes with their
    background; ``textures`` is the contrast of a group's texture with its colour, less than that of its
    label.
    """

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
    words: float = 4.5
    shapes: float = 3.0
    textures: float = 2.2


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
    groups=GROUP_COLOURS,
    other=OTHER_COLOUR,
    text="#1C1C1C",
    faint="#5E646A",
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
HIGH_CONTRAST = Palette(
    groups=("#6FC4F5", "#FFB000", "#00D49A", "#FFF25C", "#F09CCB", "#FF8A3D"),
    other="#D8D8D8",
    text="#FFFFFF",
    faint="#C4CCD2",
    warn="#FFA48A",
    mark="#FFFFFF",
    now="#FFFFFF",
    wall="#C4CCD2",
    sphere="#FFF25C",
    robot="#FFFFFF",
    trail="#F09CCB",
    true_scan="#6FC4F5",
    seen_scan="#FFB000",
    words=7.0,
    shapes=4.5,
    textures=3.0,
)
HIGH_CONTRAST_LIGHT = Palette(
    groups=("#040457", "#570404", "#005A5A", "#7A10A8", "#8F2A00"),
    other="#3A3A3A",
    text="#000000",
    faint="#3D4247",
    warn="#8F0F00",
    mark="#000000",
    now="#000000",
    wall="#3D4247",
    sphere="#5C4600",
    robot="#000000",
    trail="#7A10A8",
    true_scan="#0B3F80",
    seen_scan="#8F2A00",
    words=7.0,
    shapes=4.5,
    textures=3.0,
)
