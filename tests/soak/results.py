"""What the soaks came to last, kept in a small file beside them; ``--record`` of a soak writes its part."""

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import TypeAlias

FILE = Path(__file__).with_name("results.toml")
Entry: TypeAlias = Mapping[str, str | int | float]
_HEAD = "# What the soaks came to last. Each writes its part with --record; nothing here is written by hand."


def record(soak: str, name: str, entry: Entry, file: Path = FILE) -> None:
    """Put in, or replace, what came of one part of a soak: its date, its seed, and its figures."""
    known = read(file)
    known.setdefault(soak, {})[name] = entry
    lines = [_HEAD]
    for each, parts in known.items():
        width = max(map(len, parts))
        lines += ["", f"[{each}]", *(f"{part:<{width}} = {_row(row)}" for part, row in parts.items())]
    file.write_text("\n".join([*lines, ""]), encoding="utf-8")


def read(file: Path = FILE) -> dict[str, dict[str, Entry]]:
    """What is recorded, by soak and part."""
    return tomllib.loads(file.read_text(encoding="utf-8")) if file.is_file() else {}


def _row(entry: Entry) -> str:
    cells = (
        f'{name} = "{value}"' if isinstance(value, str) else f"{name} = {value}"
        for name, value in entry.items()
    )
    return f"{{ {', '.join(cells)} }}"
