"""The configuration file: keys and appearance; faults are reported with their lines."""

import re
import tomllib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from difflib import get_close_matches
from pathlib import Path
from typing import NamedTuple

from textual.theme import BUILTIN_THEMES

from cbtui.keys.config_keys import read_keys
from cbtui.keys.keymap import Keymap
from cbtui.looks.colour_themes import THEMES
from cbtui.looks.theme import Charset
from lessons.personal import config_folder
from sim.files import plain_toml, untrusted

AUTO = "auto"
_TABLES = ("keys", "display")
_CHOICES = {
    "theme": [*(theme.name for theme in THEMES), *BUILTIN_THEMES],
    "charset": [AUTO, *Charset],
    "screen_reader": ["on", "off"],
}


@dataclass(frozen=True)
class Config:
    """The user's settings; None stands for the console's default."""

    theme: str | None = None
    charset: str | None = None
    screen_reader: str | None = None
    keymap: Keymap = field(default_factory=Keymap)


class ParsedConfig(NamedTuple):
    """A configuration without its faulty entries; ``complaints`` has a sentence for each of those."""

    config: Config
    complaints: list[str]


def standard_path() -> Path:
    """The path of the user's configuration."""
    return config_folder() / "config.toml"


def read_file(path: Path) -> ParsedConfig:
    """Read a configuration file."""
    try:
        text = untrusted.read_text(path)
    except UnicodeDecodeError:
        return ParsedConfig(Config(), [f"{path} is not UTF-8 text"])
    except OSError as error:
        return ParsedConfig(Config(), [f"{path} cannot be read: {error.strerror}"])
    return read_text(text, path.name)


def read_text(text: str, name: str) -> ParsedConfig:
    """Parse a configuration; ``name`` is the file name in complaints."""
    try:
        document = plain_toml.load(text)
    except tomllib.TOMLDecodeError as error:
        return ParsedConfig(Config(), [f"{name}:{_fault(error, text)}"])
    except ValueError as error:  # a number that Python cannot convert
        return ParsedConfig(Config(), [f"{name}: {error}"])
    complaints: list[tuple[int, str]] = []
    lines = _lines_of(text)

    def complain(entry: str, sentence: str) -> None:
        complaints.append((_line(lines, entry), sentence))

    for each in document:
        if each not in _TABLES:
            complain(each, f"there is no table [{each}]{_meant(each, _TABLES)}")
    keys = _table(document, "keys", complain)
    keymap = read_keys(dict(_flat(keys)), lambda entry, sentence: complain(f"keys.{entry}", sentence))
    display = _display(_table(document, "display", complain), complain)
    config = Config(display.get("theme"), display.get("charset"), display.get("screen_reader"), keymap)
    return ParsedConfig(config, [f"{name}:{line}: {sentence}" for line, sentence in sorted(complaints)])


def _table(
    document: Mapping[str, object], name: str, complain: Callable[[str, str], None]
) -> Mapping[str, object]:
    table = document.get(name, {})
    if isinstance(table, dict):
        return table
    complain(name, f"{name} has to be a table; write [{name}], and its entries below")
    return {}


def _display(table: Mapping[str, object], complain: Callable[[str, str], None]) -> dict[str, str]:
    right = {}
    for name, value in table.items():
        if name not in _CHOICES:
            complain(
                f"display.{name}", f"there is no entry {name} in [display]{_meant(name, tuple(_CHOICES))}"
            )
        elif not isinstance(value, str):
            complain(f"display.{name}", f"{name} has to be a name in quotation marks")
        elif value not in _CHOICES[name]:
            complain(f"display.{name}", unknown(name, value))
        else:
            right[name] = value
    return right


def known(choice: str, value: str) -> bool:
    """Tell whether there is such a ``theme`` or ``charset``."""
    return value in _CHOICES[choice]


def unknown(choice: str, value: str) -> str:
    """Return the sentence on a ``theme`` or ``charset`` that does not exist."""
    near = get_close_matches(value, _CHOICES[choice], n=1)
    own = _CHOICES[choice][:4]
    return f"there is no {choice} {value!r}; " + (
        f"did you mean {near[0]!r}?" if near else f"choose {', '.join(own[:-1])} or {own[-1]}"
    )


def _meant(name: str, known: tuple[str, ...]) -> str:
    near = get_close_matches(name, known, n=1)
    return f"; did you mean {near[0]}?" if near else f"; there are {' and '.join(known)}"


def _flat(table: Mapping[str, object], above: str = "") -> Iterator[tuple[str, object]]:
    for name, value in table.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{above}{name}.")
        else:
            yield f"{above}{name}", value


# line numbers, which tomllib does not provide


def _lines_of(text: str) -> dict[str, int]:
    """The line of each heading and entry, by its dotted name."""
    lines: dict[str, int] = {}
    heading = ""
    for number, line in enumerate(map(str.strip, text.splitlines()), start=1):
        if line.startswith("["):
            heading = _plain(line.lstrip("[").partition("]")[0])
            lines.setdefault(heading, number)
        elif "=" in line:
            lines.setdefault(".".join(filter(None, (heading, _plain(line.partition("=")[0])))), number)
    return lines


def _plain(dotted: str) -> str:
    return re.sub(r"""["'\s]""", "", dotted)


def _line(lines: Mapping[str, int], entry: str) -> int:
    """The line of an entry, or of the nearest table around it: entries of an inline table share a line."""
    while entry and entry not in lines:
        entry = entry.rpartition(".")[0]
    return lines.get(entry, 1)


def _fault(error: tomllib.TOMLDecodeError, text: str) -> str:
    """The line and the message of a TOML syntax error."""
    found = re.fullmatch(r"(.*) \(at (?:line (\d+), column \d+|end of document)\)", str(error))
    if found is None:
        return f" {error}"
    what = found[1][0].lower() + found[1][1:]
    return f"{found[2]}: {what}" if found[2] else f"{len(text.splitlines())}: {what} at the end of the file"
