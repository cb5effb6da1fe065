"""The options on keys and appearance, and the configuration that they override."""

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from stat import S_ISREG
from typing import TYPE_CHECKING, NamedTuple

from cbtui.commands.options.targets import refuse
from sim.files.untrusted import mode_of

if TYPE_CHECKING:
    from cbtui.keys.keymap import Keymap

_CHARSETS = ("auto", "braille", "block", "ascii")
_NAMES = ("charset", "theme", "config")


class Appearance(NamedTuple):
    """How the console starts.

    ``configured_charset`` may be ``auto``; ``charset`` is what that resolved to. ``complaints`` are sentences
    on faults in the configuration.
    """

    charset: str
    configured_charset: str
    theme: str
    keys: "Keymap"
    complaints: Sequence[str]
    screen_reader: bool = False
    """Whether to print lines instead of drawing a screen."""


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options to a command; ``set_defaults`` sets their defaults."""
    parser.add_argument(
        "--charset",
        choices=_CHARSETS,
        default=argparse.SUPPRESS,
        help="what the screen is drawn with (auto: braille where the locale is UTF-8, else ascii)",
    )
    parser.add_argument(
        "--theme",
        metavar="THEME",
        default=argparse.SUPPRESS,
        help="theme: dark, light, high-contrast, high-contrast-light, or another that ctrl+p offers (dark)",
    )
    parser.add_argument(
        "--screen-reader",
        action="store_const",
        const="on",
        default=argparse.SUPPRESS,
        help="tell runs, recordings, comparisons and puzzles in plain lines, for screen readers and braille",
    )
    parser.add_argument(
        "--config",
        metavar="FILE.toml",
        default=argparse.SUPPRESS,
        help="keys and looks, instead of your own config.toml; cbtui keys writes one to begin with",
    )


def set_defaults(parser: argparse.ArgumentParser) -> None:
    """Set the defaults once on the main parser, so that an option may stand before or after the command."""
    parser.set_defaults(**dict.fromkeys(_NAMES), screen_reader=None)


def given(options: argparse.Namespace) -> list[str]:
    """Return the given options as words of a command line."""
    values = ((name, getattr(options, name)) for name in _NAMES)
    return [word for name, value in values if value is not None for word in (f"--{name}", value)]


def check_theme(options: argparse.Namespace) -> None:
    """Exit with code 2 and one line if there is no such theme."""
    if options.theme is None:
        return
    from cbtui.keys.config import known, unknown

    if not known("theme", options.theme):
        refuse(unknown("theme", options.theme))


def appearance(options: argparse.Namespace) -> Appearance:
    """Return the appearance by the options, else by the configuration, else by the terminal.

    Exits with code 2 if a configuration named with ``--config`` has faults.
    """
    from cbtui.keys.config import AUTO, Config, ParsedConfig, read_file, standard_path
    from cbtui.looks import colour_themes
    from cbtui.terminal.capabilities import charset_of

    reading = ParsedConfig(Config(), [])
    if options.config is not None:
        reading = read_file(Path(options.config))
        if reading.complaints:
            refuse("\ncbtui: ".join(reading.complaints))
    elif _may_be_there(standard_path()):
        reading = read_file(standard_path())
    config = reading.config
    configured = options.charset or config.charset or AUTO
    charset = configured
    if configured == AUTO:
        charset = charset_of(os.environ, bool(sys.flags.utf8_mode), sys.stderr.encoding or "utf-8")
    theme = options.theme or config.theme or colour_themes.STANDARD
    in_lines = (options.screen_reader or config.screen_reader) == "on"
    return Appearance(charset, configured, theme, config.keymap, reading.complaints, in_lines)


def _may_be_there(path: Path) -> bool:
    try:
        return S_ISREG(mode_of(path))
    except OSError:  # reading the file reports it
        return True
