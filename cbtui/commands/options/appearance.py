"""The options on keys and looks of everything that opens the console, and the configuration behind them."""

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from cbtui.commands.options.targets import refuse

if TYPE_CHECKING:
    from cbtui.app import CbtuiApp
    from cbtui.keys.keymap import Keymap

_CHARSETS = ("auto", "braille", "block", "ascii")
_NAMES = ("charset", "theme", "config")


class Appearance(NamedTuple):
    """What the console begins with.

    ``configured_charset`` may be ``auto``, ``charset`` is what came of it; ``complaints`` are sentences on
    what is wrong in the configuration.
    """

    charset: str
    configured_charset: str
    theme: str
    keys: "Keymap"
    complaints: Sequence[str]


def add_options(parser: argparse.ArgumentParser) -> None:
    """Give a command the options. What they are when nobody gives them says ``set_defaults``."""
    parser.add_argument(
        "--charset",
        choices=_CHARSETS,
        default=argparse.SUPPRESS,
        help="what the screen is drawn with (auto: braille where the locale is UTF-8, else ascii)",
    )
    parser.add_argument(
        "--theme",
        metavar="NAME",
        default=argparse.SUPPRESS,
        help="colours: dark, light, high-contrast, high-contrast-light, or another that ctrl+p offers (dark)",
    )
    parser.add_argument(
        "--config",
        metavar="FILE.toml",
        default=argparse.SUPPRESS,
        help="keys and looks, instead of your own config.toml; cbtui keys writes one to begin with",
    )


def set_defaults(parser: argparse.ArgumentParser) -> None:
    """Say that nothing is given; so that an option may stand before the command as well as after it."""
    parser.set_defaults(**dict.fromkeys(_NAMES))


def given(options: argparse.Namespace) -> list[str]:
    """Return the options again as words of a command line."""
    values = ((name, getattr(options, name)) for name in _NAMES)
    return [word for name, value in values if value is not None for word in (f"--{name}", value)]


def appearance(options: argparse.Namespace) -> Appearance:
    """Return what the console begins with: what the options say, else the configuration, else the terminal.

    A configuration named with ``--config`` that has something wrong in it ends the program with 2.
    """
    from cbtui.keys.config import AUTO, Config, Reading, known, read_file, standard_path, unknown
    from cbtui.looks import colour_themes
    from cbtui.terminal.capabilities import charset_of

    reading = Reading(Config(), [])
    if options.config is not None:
        reading = read_file(Path(options.config))
        if reading.complaints:
            refuse("\ncbtui: ".join(reading.complaints))
    elif _may_be_there(standard_path()):
        reading = read_file(standard_path())
    if options.theme is not None and not known("theme", options.theme):
        refuse(unknown("theme", options.theme))
    config = reading.config
    configured = options.charset or config.charset or AUTO
    charset = configured
    if configured == AUTO:
        charset = charset_of(os.environ, bool(sys.flags.utf8_mode), sys.stderr.encoding or "utf-8")
    theme = options.theme or config.theme or colour_themes.STANDARD
    return Appearance(charset, configured, theme, config.keymap, reading.complaints)


def _may_be_there(path: Path) -> bool:
    try:
        return path.is_file()
    except OSError:  # which reading it tells of
        return True


def console_of(look: Appearance, **begins_with: Any) -> "CbtuiApp":
    """Return the console with those looks; the other arguments are ``CbtuiApp``'s own."""
    from cbtui.app import CbtuiApp

    return CbtuiApp(
        charset=look.charset, theme=look.theme, keys=look.keys, complaints=look.complaints, **begins_with
    )
