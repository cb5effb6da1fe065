"""The figures that were measured earlier, kept in a small file beside this one."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

FILE = Path(__file__).with_name("recorded.toml")


@dataclass(frozen=True)
class Records:
    """By a figure's name: what it was ``before`` the executors were made quick, and what it was ``last``.

    ``load`` is how many processes wanted a core a minute before the last measurement, ``machine`` where.
    """

    before: Mapping[str, float]
    last: Mapping[str, float]
    load: Mapping[str, float] = field(default_factory=dict)
    machine: str = ""


def read(file: Path = FILE) -> Records:
    """The records of the file."""
    rows = tomllib.loads(file.read_text(encoding="utf-8"))
    machine = rows.pop("machine", "")
    return Records(_column(rows, "before"), _column(rows, "last"), _column(rows, "load"), machine)


def write(records: Records, file: Path = FILE) -> None:
    """Put records into the file."""
    rows = [_row(name, records) for name in {**records.last, **records.before}]
    told = "# python -m tests.benchmarks --record measures last and load anew; nothing is written by hand."
    text = "\n".join([told, f'machine = "{records.machine}"', *rows])
    file.write_text(f"{text}\n", encoding="utf-8")


def _column(rows: Mapping[str, Mapping[str, float]], name: str) -> dict[str, float]:
    return {figure: row[name] for figure, row in rows.items() if name in row}


def _row(figure: str, records: Records) -> str:
    columns = {"before": records.before, "last": records.last, "load": records.load}
    cells = ", ".join(
        f"{name} = {column[figure]:5.4g}" for name, column in columns.items() if figure in column
    )
    quoted = f'"{figure}"'
    return f"{quoted:<44}= {{ {cells} }}"
