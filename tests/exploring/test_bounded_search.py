"""All schedules within a bound, counted by hand for programs of a few steps."""

from collections.abc import Callable, Sequence
from functools import partial
from itertools import islice
from math import factorial

import pytest

from cbtui.runs.judged.bounded_search import BoundedSearch, Branch, of_all_parts
from sim.clock.moves import Choice, MovesSchedule, moves_of, moves_text
from sim.clock.strategies import schedule_of
from sim.trace.events import ThreadChosen
from tests.support.simulation import Simulation, simulate

Program = Callable[[Simulation, list[str]], None]


def searched(
    program: Program, preemptions: int, limit: int = 1000, part: int = 1, parts: int = 1
) -> tuple[dict[str, str], BoundedSearch]:
    """What each schedule of a program noted, by its seed."""
    search, found = BoundedSearch(preemptions, limit, part, parts), {}
    for seed in search:
        found[seed], choices = played(program, seed)
        search.take(seed, (), choices)
    return found, search


def played(program: Program, seed: str) -> tuple[str, list[ThreadChosen]]:
    """What a schedule of a program noted, and its choices."""
    choices: list[ThreadChosen] = []
    noted: list[str] = []
    schedule = schedule_of(seed)
    assert isinstance(schedule, MovesSchedule)
    decide = schedule.decide

    def take(choice: Choice) -> int:
        chosen = decide(choice)
        choices.append(
            ThreadChosen(0, choice.number, len(choice.options), chosen, choice.preempts, choice.state)
        )
        return chosen

    schedule.decide = take

    def run(simulation: Simulation) -> None:
        schedule.now = simulation.clock.now
        program(simulation, noted)
        simulation.sleep(1)

    simulate(run, schedule=schedule)
    return "".join(noted), choices


def threads(*data: Sequence[str]) -> Program:
    """Threads A, B, … each of which has a step with each of its data, and notes it."""

    def program(simulation: Simulation, noted: list[str]) -> None:
        def thread(name: str, mine: Sequence[str]) -> None:
            for each in mine:
                simulation.clock.switch_point({each: True})  # type: ignore[call-arg]
                noted.append(name)

        for place, mine in enumerate(data):
            name = chr(ord("A") + place)
            simulation.start(partial(thread, name, mine), name)

    return program


@pytest.mark.parametrize(("preemptions", "number"), [(0, 2), (1, 6), (2, 14), (3, 18), (4, 20)])
def test_two_threads_with_three_steps_each(preemptions: int, number: int) -> None:
    # 0: AAABBB. 1: A^i BBB A^(3-i). 2: A^i B^j A^(3-i) B^(3-j). 3: A^i B^j A B.. A, 4: ABABAB; and B first.
    found, search = searched(threads("xxx", "xxx"), preemptions)
    assert len(found) == len(set(found.values())) == number
    assert search.is_complete


def test_the_whole_bound_is_every_order() -> None:
    found, _ = searched(threads("xx", "x", "x"), 4)
    assert set(found.values()) == {"".join(order) for order in _orders("AABC")}


def _orders(steps: str) -> set[str]:
    return (
        {steps}
        if len(steps) < 2
        else {f"{each}{rest}" for each in steps for rest in _orders(steps.replace(each, "", 1))}
    )


def test_orders_that_come_to_the_same_state_are_followed_once() -> None:
    # Steps that depend on each other: 4! orders. If they do not, each subset that is done is a state, where
    # the threads that are left but one are tried: 3 at first, then 4 * 2, then 6 * 1, and the first run.
    dependent, _ = searched(threads(*"xxxx"), 0)
    independent, _ = searched(threads(*"wxyz"), 0)
    assert (len(dependent), len(independent)) == (factorial(4), 1 + 3 + 8 + 6)


def test_two_locks_in_two_orders_come_to_every_deadlock() -> None:
    # One thread after the other: 2. One is stopped between its locks, the other comes to its second one: 2
    # more, both deadlocks; with a second stop there, which makes no difference, 2 more.
    def program(simulation: Simulation, noted: list[str]) -> None:
        held: dict[str, str] = {}

        def thread(name: str, locks: str) -> None:
            for lock in locks:
                simulation.clock.switch_point({lock: True})  # type: ignore[call-arg]
                while lock in held:
                    simulation.sleep(0.5 if name == "A" else 0.6)  # so that they do not wake together
                    if simulation.now > 0.4:
                        noted.append("!")
                        return
                held[lock] = name
            for lock in locks:
                del held[lock]

        simulation.start(lambda: thread("A", "xy"), "A")
        simulation.start(lambda: thread("B", "yx"), "B")

    for preemptions, number, deadlocks in ((0, 2, 0), (1, 4, 2), (2, 6, 4)):
        found, _ = searched(program, preemptions)
        assert (len(found), sum("!!" in noted for noted in found.values())) == (number, deadlocks)


@pytest.mark.parametrize(
    ("data", "preemptions", "number"), [("wxyz", 0, 18), ("xxxx", 0, 24), (("xxx", "xxx"), 2, 14)]
)
@pytest.mark.parametrize("parts", [1, 2, 3, 5])
def test_parts_together_count_the_schedules_of_the_whole_search(
    data: Sequence[str], preemptions: int, number: int, parts: int
) -> None:
    whole, _ = searched(threads(*data), preemptions)
    found: dict[str, str] = {}
    branches: dict[str, tuple[Branch, ...]] = {}
    for part in range(1, parts + 1):
        noted, search = searched(threads(*data), preemptions, part=part, parts=parts)
        found |= noted
        branches |= search.branches
    seeds = of_all_parts(preemptions, branches)
    assert len(seeds) == number
    assert {seed: found[seed] for seed in seeds} == whole


@pytest.mark.parametrize(("data", "preemptions"), [("wxyz", 0), (("xxx", "yxy"), 2)])
@pytest.mark.parametrize("at_once", [2, 3, 5])
def test_runs_at_once_that_end_in_any_order_count_as_one_after_the_other(
    data: Sequence[str], preemptions: int, at_once: int
) -> None:
    whole, in_order = searched(threads(*data), preemptions)
    assert in_order.counted == list(whole)
    search, running, found = BoundedSearch(preemptions, 1000), list[str](), dict[str, str]()
    while running := [*running, *islice(search, at_once - len(running))]:
        seed = running.pop()
        found[seed], choices = played(threads(*data), seed)
        search.take(seed, (), choices)
    assert search.is_complete
    assert {seed: found[seed] for seed in search.counted} == whole


def test_all_runs_count_where_one_is_missing_that_another_order_needs() -> None:
    _, search = searched(threads(*"wxyz"), 0)
    branches = dict(search.branches)
    branches.popitem()
    assert of_all_parts(0, branches) == list(branches)


def test_a_search_stops_at_its_limit_and_says_so() -> None:
    found, search = searched(threads("xxx", "xxx"), 2, limit=5)
    assert len(found) == 5
    assert not search.is_complete


def test_a_seed_says_the_moves_and_the_same_moves_are_the_same_run() -> None:
    assert moves_text({9: 2, 3: 1}) == "moves:3=1,9=2"
    assert moves_of("3=1,9=2") == {3: 1, 9: 2}
    found, _ = searched(threads("xxx", "xxx"), 2)
    again, _ = searched(threads("xxx", "xxx"), 2)
    assert found == again
