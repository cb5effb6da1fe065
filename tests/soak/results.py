"""What soaks and the like came to last, kept in a small file beside them; ``--record`` writes its part."""

import re
import time
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import TypeAlias

FILE = Path(__file__).with_name("results.toml")
Entry: TypeAlias = Mapping[str, str | int | float]
_HEAD = "# What was measured last. Each part is written with --record, and nothing here by hand."
_BARE = re.compile(r"[A-Za-z0-9_-]+")


def record(soak: str, name: str, entry: Entry, file: Path = FILE) -> None:
    """Put in, or replace, what came of one part of a soak: its date, its seed, and its figures."""
    known = read(file)
    known.setdefault(soak, {})[name] = entry
    lines = [_HEAD]
    for each, parts in known.items():
        rows = {_key(part): _row(row) for part, row in parts.items()}
        width = max(map(len, rows))
        lines += ["", f"[{each}]", *(f"{part:<{width}} = {row}" for part, row in rows.items())]
    file.write_text("\n".join([*lines, ""]), encoding="utf-8")


def today() -> str:
    """The date that goes with what is recorded now."""
    return time.strftime("%Y-%m-%d", time.gmtime())


def read(file: Path = FILE) -> dict[str, dict[str, Entry]]:
    """What is recorded, by soak and part."""
    return tomllib.loads(file.read_text(encoding="utf-8")) if file.is_file() else {}


def _key(name: str) -> str:
    return name if _BARE.fullmatch(name) else f'"{name}"'


def _row(entry: Entry) -> str:
    cells = (
        f'{name} = "{value}"' if isinstance(value, str) else f"{name} = {value}"
        for name, value in entry.items()
    )
    return f"{{ {', '.join(cells)} }}"
