"""The programs with seeded bugs: the usual order shows none, and a search within a bound finds them."""

import re
from contextlib import closing
from pathlib import Path

import pytest

from cbtui.runs.judged.bounded_search import BoundedSearch
from tests.exploring.seeded_bugs import BUGS, PERIOD, SHOWN_BY_USUAL_ORDER
from tests.exploring.strategies import MOST, PREEMPTIONS, exploration
from tests.support.daily import first_daily


def test_there_are_enough_of_them() -> None:
    assert len(BUGS) >= 30


@pytest.mark.parametrize("name", first_daily(*(name for name in BUGS if name not in SHOWN_BY_USUAL_ORDER)))
def test_the_usual_order_shows_no_bug(name: str, tmp_path: Path) -> None:
    ((_, result),) = exploration(BUGS[name], tmp_path).results([0])
    assert result.well


@pytest.mark.slow
def test_a_callback_that_waits_for_what_was_told_before_fails_in_a_run_that_lasts(tmp_path: Path) -> None:
    source = re.sub(r"assert (self\.bell\.wait)\(.*", r"\1()", BUGS["told before anybody waited"])
    source = source.replace(f"create_timer({PERIOD}", "create_timer(4.0")  # so that it is not told again
    results = exploration(source, tmp_path, seconds=7.9).search(BoundedSearch(1, 300))
    with closing(results):
        first = next(failure for _, result in results for failure in result.failures)
    assert first.what == "a callback waits without end"


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=pytest.mark.bulk if place % 20 else pytest.mark.slow)
        for place, name in enumerate(BUGS)
    ],
)
def test_at_most_two_preemptions_show_each_bug(name: str, tmp_path: Path) -> None:
    results = exploration(BUGS[name], tmp_path).search(BoundedSearch(PREEMPTIONS, MOST))
    assert any(not result.well for _, result in results)
