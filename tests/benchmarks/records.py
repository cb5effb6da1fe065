"""The figures that were measured earlier, kept in a small file beside this one."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

FILE = Path(__file__).with_name("recorded.toml")


@dataclass(frozen=True)
class Records:
    """By a figure's name: what it was ``before`` the executors were made quick, and what it was ``last``."""

    before: Mapping[str, float]
    last: Mapping[str, float]


def read(file: Path = FILE) -> Records:
    """The records of the file."""
    rows = tomllib.loads(file.read_text(encoding="utf-8"))
    return Records(_column(rows, "before"), _column(rows, "last"))


def write(records: Records, file: Path = FILE) -> None:
    """Put records into the file."""
    rows = [_row(name, records) for name in {**records.before, **records.last}]
    text = "\n".join(["# python -m tests.benchmarks --record measures the last column anew.", *rows])
    file.write_text(f"{text}\n", encoding="utf-8")


def _column(rows: Mapping[str, Mapping[str, float]], name: str) -> dict[str, float]:
    return {figure: row[name] for figure, row in rows.items() if name in row}


def _row(figure: str, records: Records) -> str:
    columns = {"before": records.before, "last": records.last}
    cells = ", ".join(
        f"{name} = {column[figure]:5.4g}" for name, column in columns.items() if figure in column
    )
    quoted = f'"{figure}"'
    return f"{quoted:<44}= {{ {cells} }}"
