"""Measures how soon each strategy finds each seeded bug: ``python -m tests.exploring.strategies``.

``--record`` keeps the table in ``strategies.toml``: how many schedules it takes on average, 0 for a bug that
no schedule showed. With ``--bounded`` it measures the search within two preemptions: which of its schedules
is the first that shows the bug.
"""

import argparse
import sys
import tempfile
from contextlib import closing
from pathlib import Path

from cbtui.runs.judged.bounded_search import BoundedSearch
from cbtui.runs.judged.exploring import Exploration
from cbtui.runs.setup.lesson_setup import RunRequest
from tests.exploring.seeded_bugs import BUGS, SECONDS
from tests.soak.results import record, today

FILE = Path(__file__).with_name("strategies.toml")
PREEMPTIONS, MOST = 2, 300
"""The bound of the search, and how many schedules it may take."""
_STRATEGIES = ("pos", "pct", "random")
"""Those that keep to the time; an audit takes for a bug that another one is late."""
_LIMIT = 60.0


def exploration(source: str, folder: Path, seconds: float = SECONDS) -> Exploration:
    """The exploration of a program."""
    path = folder / "mine.py"
    path.write_text(source)
    return Exploration(
        RunRequest(files=[path], clock="virtual", seconds=seconds).setup(), path.name, None, _LIMIT
    )


def schedules_to_bug(source: str, strategy: str, schedules: int) -> float:
    """How many schedules of a strategy show the bug of a program once on average; 0 if none did."""
    with tempfile.TemporaryDirectory() as folder:
        seeds = [f"{strategy}:{number}" for number in range(1, schedules + 1)]
        results = exploration(source, Path(folder)).results(seeds, processes=1)
        failed = sum(not result.well for _, result in results)
    return round(schedules / failed, 1) if failed else 0


def first_schedule(source: str) -> int:
    """Which schedule of the bounded search is the first that shows the bug of a program; 0 if none does."""
    with tempfile.TemporaryDirectory() as folder:
        search = BoundedSearch(PREEMPTIONS, MOST)
        with closing(exploration(source, Path(folder)).search(search, processes=1)) as results:
            return next((place for place, (_, result) in enumerate(results, 1) if not result.well), 0)


def main() -> None:
    """Measure the bugs and print a line for each."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("bugs", nargs="*", help="parts of their names (all)")
    parser.add_argument("--schedules", type=int, default=20, help="of each strategy (%(default)s)")
    parser.add_argument("--bounded", action="store_true", help="measure the bounded search")
    parser.add_argument("--record", action="store_true", help=f"put the table into {FILE.name}")
    options = parser.parse_args()
    for name, source in BUGS.items():
        if options.bugs and not any(part in name for part in options.bugs):
            continue
        row: dict[str, float]
        if options.bounded:
            table, row = f"first-within-{PREEMPTIONS}-preemptions", {"schedule": first_schedule(source)}
        else:
            found = {each: schedules_to_bug(source, each, options.schedules) for each in _STRATEGIES}
            table, row = "schedules-to-bug", {"of": options.schedules, **found}
        sys.stdout.write(f"{name:<50}{''.join(f'{each:>8g}' for each in row.values())}\n")
        sys.stdout.flush()
        if options.record:
            record(table, name, {"date": today(), **row}, FILE)


if __name__ == "__main__":
    main()
