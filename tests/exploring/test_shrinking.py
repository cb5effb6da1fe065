"""A schedule that fails is shrunk to the moves that it takes, which are run."""

from collections.abc import Mapping
from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cbtui.runs.judged.bounded_search import BoundedSearch
from cbtui.runs.judged.shrinking import Shrinking
from sim.clock.moves import RandomMovesSchedule, moves_of, moves_text
from sim.clock.strategies import schedule_of
from sim.trace.events import ThreadChosen
from tests.exploring.test_bounded_search import played, searched, threads

CHOICES = 40


def shrunk(needed: Mapping[int, int], limit: int = 400) -> tuple[str, dict[str, bool]]:
    """The simplest seed found of a program that fails if it makes the ``needed`` moves, and what was run."""
    search, run = Shrinking(["fails", "never"], limit), {}
    for seed in search:
        moves = walked(seed) if isinstance(schedule_of(seed), RandomMovesSchedule) else moves_of(seed)
        fails = needed.items() <= moves.items()
        run[seed] = fails
        search.take(
            seed,
            ["fails"] if fails else ["otherwise"],
            [
                ThreadChosen(0, number, 3, moves.get(number, 0), number % 2 == 0, 0)
                for number in range(CHOICES)
            ],
        )
    return search.best, run


def walked(seed: str) -> dict[int, int]:
    random = Random(seed)
    return {number: option for number in range(CHOICES) if (option := random.randrange(3))}


@given(st.dictionaries(st.integers(0, CHOICES - 1), st.integers(1, 2), max_size=3))
def test_nothing_is_left_that_the_failure_does_not_need(needed: dict[int, int]) -> None:
    best, run = shrunk(needed)
    assert moves_of(best) == needed
    assert run[best]


def test_a_failure_that_is_not_met_again_is_not_shrunk() -> None:
    best, run = shrunk({1000: 1}, limit=20)
    assert best == ""
    assert [*run] == [f"walk:{number}" for number in range(1, 21)]


def test_what_a_walk_chooses_is_played_again_by_moves() -> None:
    orders = set()
    for number in range(1, 25):
        noted, choices = played(threads("xxx", "xxx"), f"walk:{number}")
        moves = moves_text({choice.number: choice.chosen for choice in choices if choice.chosen})
        assert played(threads("xxx", "xxx"), moves) == (noted, choices)
        orders.add(noted)
    assert len(orders) >= 5


@pytest.mark.parametrize("parts", [1, 2, 3])
def test_parts_of_a_search_come_to_every_order_together(parts: int) -> None:
    found = [searched(threads("xx", "x", "x"), 4, part=part, parts=parts) for part in range(1, parts + 1)]
    assert {order for orders, _ in found for order in orders.values()} == set(
        searched(threads("xx", "x", "x"), 4)[0].values()
    )
    assert all(isinstance(search, BoundedSearch) and search.is_complete for _, search in found)
