"""All schedules within a bound, counted by hand for files as a user has them.

Each thread has a few lines that write one attribute, so that each order of lines is a schedule of its own.
The main thread only waits. A thread is preempted where it is left between two of its lines.
"""

from pathlib import Path

import pytest

from cbtui.runs.judged.bounded_search import BoundedSearch, of_all_parts
from tests.exploring.strategies import exploration
from tests.support.daily import first_daily, first_row_daily

_FILE = """
import threading, time
class Shared: x = 0
shared, lock, other = Shared(), threading.Lock(), threading.Lock()
{threads}
def main():
    for name in "ABC":
        if name in globals():
            threading.Thread(target=globals()[name], name=name, daemon=True).start()
    time.sleep(0.05)
"""


def _file(**threads: str) -> str:
    return _FILE.format(threads="\n".join(f"def {name}():\n{body}" for name, body in threads.items()))


def _writes(number: int, indent: str = "    ") -> str:
    return f"{indent}shared.x = 1\n" * number


FOUR_AND_TWO = _file(A=_writes(4), B=_writes(2))
TWO_TWO_ONE = _file(A=_writes(2), B=_writes(2), C=_writes(1))
LOCKED = _file(
    A="    with lock:\n" + _writes(2, " " * 8),
    B="    with lock:\n" + _writes(2, " " * 8),
)
CROSSED = _file(
    A="    with lock:\n        with other: pass",
    B="    with other:\n        with lock: pass",
)


@pytest.mark.parametrize(
    ("source", "preemptions", "schedules", "failing"),
    first_row_daily(
        # One thread after the other: 2. The first one is stopped between its locks: 2 more, both a deadlock.
        # The second one is stopped there, too, and the first one goes on to the same deadlock: 2 more.
        (CROSSED, 2, 6, 4),
        (CROSSED, 1, 4, 2),
        (CROSSED, 0, 2, 0),
        # AAAA in r blocks and BB in s blocks, in turn: C(3, r-1) * C(1, s-1) ways for each thread that can
        # begin. The thread that ends first is left once without a preemption: r + s - 2 preemptions.
        (FOUR_AND_TWO, 0, 2, 0),  # r=s=1: 2
        (FOUR_AND_TWO, 1, 6, 0),  # r=2, s=1: 3; r=1, s=2: 1
        (FOUR_AND_TWO, 2, 12, 0),  # r=s=2: 2 * 3 * 1
        (FOUR_AND_TWO, 3, 15, 0),  # r=3, s=2: 3 * 1; all C(6, 2) orders
        # A preemption for each of A and B whose two lines do not follow each other. Of 5!/(2! 2!) = 30 orders
        # both do in 3! = 6, and each does in 4!/2! = 12.
        (TWO_TWO_ONE, 0, 6, 0),
        (TWO_TWO_ONE, 1, 6 + 2 * (12 - 6), 0),
        (TWO_TWO_ONE, 2, 30, 0),
        # One whole thread after the other: 2. The first one is stopped before one of its two lines, and the
        # other comes as far as the lock: 2 more for each. Then it waits, and no further choice is left.
        (LOCKED, 0, 2, 0),
        (LOCKED, 1, 6, 0),
        (LOCKED, 2, 6, 0),
    ),
)
def test_schedules_of_a_file(
    source: str, preemptions: int, schedules: int, failing: int, tmp_path: Path
) -> None:
    search = BoundedSearch(preemptions, 100)
    found = dict(exploration(source, tmp_path, 0.06).search(search))
    assert search.is_complete
    assert (len(found), sum(not each.well for each in found.values())) == (schedules, failing)


@pytest.mark.parametrize("parts", first_daily(2, 1, 3))
def test_parts_of_a_file_are_together_the_whole(parts: int, tmp_path: Path) -> None:
    explored = exploration(CROSSED, tmp_path, 0.06)
    searches = [BoundedSearch(2, 100, part, parts) for part in range(1, parts + 1)]
    found = {seed: result for each in searches for seed, result in explored.search(each)}
    branches = {seed: search.branches[seed] for search in searches for seed in search.counted}
    whole = BoundedSearch(2, 100)
    made = dict(explored.search(whole))
    assert {seed: found[seed] for seed in of_all_parts(2, branches)} == {
        each: made[each] for each in whole.counted
    }
