"""The console's colour themes for Textual, and the picture palette of each theme."""

from dataclasses import replace

from textual.theme import BUILTIN_THEMES, Theme

from cbtui.looks.palettes import DARK, HIGH_CONTRAST, HIGH_CONTRAST_LIGHT, LIGHT, Palette

STANDARD = "dark"

_SOLID = {"text": "auto 100%", "text-muted": "auto 85%", "text-disabled": "auto 75%"}


def _cursor(behind: str, text: str) -> dict[str, str]:
    """Colours of the highlighted list entry, on which the theme's accents are readable."""
    return {
        "block-cursor-background": behind,
        "block-cursor-foreground": text,
        "block-cursor-blurred-background": behind,
        "block-cursor-blurred-foreground": text,
    }


THEMES = (
    replace(
        BUILTIN_THEMES["textual-dark"],
        name=STANDARD,
        variables={"text-disabled": "auto 54%", **_cursor(behind="#0B4F8A", text="#FFFFFF")},
    ),
    Theme(
        name="light",
        dark=False,
        primary="#004578",
        secondary="#0178D4",
        warning="#8A5A00",
        error="#A3203F",
        success="#1F7A3A",
        accent="#8A5A00",
        foreground="#1F1F1F",
        background="#FFFFFF",
        surface="#F5F5F5",
        panel="#E9ECEF",
        variables={"text-disabled": "auto 58%", **_cursor(behind="#CFE3F7", text="#1F1F1F")},
    ),
    Theme(
        name="high-contrast",
        dark=True,
        primary="#7CC7FF",
        secondary="#B8E0FF",
        warning="#FFC24D",
        error="#FF9AA8",
        success="#7CF0A8",
        accent="#FFD34D",
        foreground="#FFFFFF",
        background="#000000",
        surface="#0A0A0A",
        panel="#1A1A1A",
        text_alpha=1.0,
        variables={
            **_SOLID,
            **_cursor(behind="#003E75", text="#FFFFFF"),
            "primary-muted": "#9AA7B0",
            "border-blurred": "#9AA7B0",
            "scrollbar": "#9AA7B0",
        },
    ),
    Theme(
        name="high-contrast-light",
        dark=False,
        primary="#00315A",
        secondary="#003F73",
        warning="#5C3B00",
        error="#7A0F28",
        success="#0B4D20",
        accent="#5C3B00",
        foreground="#000000",
        background="#FFFFFF",
        surface="#FAFAFA",
        panel="#EDEDED",
        text_alpha=1.0,
        variables={
            **_SOLID,
            **_cursor(behind="#CFE3F7", text="#000000"),
            "primary-muted": "#4A545C",
            "border-blurred": "#4A545C",
            "scrollbar": "#4A545C",
        },
    ),
)

_PALETTES = {"high-contrast": HIGH_CONTRAST, "high-contrast-light": HIGH_CONTRAST_LIGHT}


def palette_of(theme: Theme) -> Palette:
    """Return the palette for a theme of the console or of Textual."""
    return _PALETTES.get(theme.name, DARK if theme.dark else LIGHT)
