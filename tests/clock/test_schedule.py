"""The choices among orders of threads, without a clock and without threads."""

from itertools import pairwise, permutations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.clock.schedule import Schedule, Seed
from sim.clock.strategies import BusyMachine, PctSchedule, schedule_of

SEEDS = st.integers(1, 2**63)
QUESTIONS = st.lists(st.tuples(st.sampled_from("nlc"), st.integers(1, 5)), max_size=60)


def answers(schedule: Schedule, questions: list[tuple[str, int]]) -> list[int]:
    """What a schedule says to next, leaves and choose among some threads."""
    said = []
    for question, number in questions:
        threads = range(number)
        match question:
            case "n":
                said.append(schedule.next(threads))
            case "l":
                said.append(int(schedule.yields("me", threads)))
            case _:
                said.append(schedule.choose(number))
    return said


def order(seed: int, names: str) -> str:
    """In which order threads go on that all wait at once."""
    schedule, ready = PctSchedule(seed), list(names)
    return "".join(ready.pop(schedule.next(ready)) for _ in names)


def test_without_a_seed_the_first_goes_on_and_nobody_is_left() -> None:
    for schedule in (Schedule(), schedule_of(None), schedule_of(0)):
        assert not schedule.explores
        assert answers(schedule, [("n", 5), ("l", 5), ("c", 5)]) == [0, 0, 0]


@given(SEEDS, QUESTIONS)
def test_the_same_seed_asked_the_same_says_the_same(seed: int, questions: list[tuple[str, int]]) -> None:
    assert answers(schedule_of(seed), questions) == answers(schedule_of(seed), questions)


@given(SEEDS, st.integers(1, 9))
def test_only_who_is_there_is_chosen(seed: int, number: int) -> None:
    schedule = schedule_of(seed)
    assert all(0 <= schedule.next(range(number)) < number for _ in range(20))
    assert all(0 <= schedule.choose(number) < number for _ in range(20))


def test_seeds_come_to_every_order_of_a_few_threads() -> None:
    assert {order(seed, "abcd") for seed in range(1, 1_000)} == set(map("".join, permutations("abcd")))


def test_no_thread_is_left_out_for_ever() -> None:
    for seed in range(1, 50):
        schedule = PctSchedule(seed)
        assert {schedule.next("ab") for _ in range(2_000)} == {0, 1}


def test_some_seeds_keep_to_one_thread_for_long_and_others_switch_often() -> None:
    switches = []
    for seed in range(1, 50):
        schedule = PctSchedule(seed)
        chosen = [schedule.next("ab") for _ in range(1_000)]
        switches.append(sum(one != two for one, two in pairwise(chosen)))
    assert min(switches) < 50
    assert max(switches) > 300


def test_a_running_thread_is_left_only_for_one_that_is_to_go_first() -> None:
    for seed in range(1, 50):
        schedule = PctSchedule(seed)
        for _ in range(50):
            if schedule.yields("a", ["b", "c"]):
                ready = ["b", "c", "a"]
                assert schedule._priority("a") < max(map(schedule._priority, ready[:2]))


def order_of_steps(schedule: Schedule, steps: dict[str, list[str]]) -> list[tuple[str, str]]:
    """In which order threads take their steps, each with its data; they are left in front of any."""
    ready, left, order = [*steps], set[str](), []
    while ready:
        running = ready.pop(schedule.next(ready))
        while steps[running] and (
            running in left or not schedule.yields(running, ready, {steps[running][0]: True})
        ):
            left.discard(running)
            order.append((running, steps[running].pop(0)))
        if steps[running]:
            left.add(running)
            ready.append(running)
    return order


def test_steps_that_conflict_come_in_both_orders_however_many_others_there_are() -> None:
    """A has one step, B twenty in front of its own with that data; at random A nearly always comes first."""
    first = {"pos": 0, "random": 0}
    for strategy in first:
        for seed in range(1, 200):
            steps = {"A": ["x"], "B": [*map(str, range(20)), "x"]}
            order = order_of_steps(schedule_of(f"{strategy}:{seed}"), steps)
            first[strategy] += next(name for name, data in order if data == "x") == "B"
    assert first["pos"] > 2 * first["random"]


@pytest.mark.parametrize("seed", [3, "pct:3", "pos:3", "random:3", "busy:3"])
def test_a_seed_with_a_strategy_makes_the_same_choices_again(seed: Seed) -> None:
    questions = [(question, number) for number in range(1, 5) for question in "nlc"] * 4
    assert answers(schedule_of(seed), questions) == answers(schedule_of(seed), questions)


def test_what_a_schedule_knows_of_a_thread_goes_with_it() -> None:
    schedule = PctSchedule(3)
    schedule.next(["a", "b"])
    schedule.forget("a")
    schedule.forget("never seen")
    assert list(schedule._priorities) == ["b"]


def test_on_a_busy_machine_some_waits_end_late_and_elsewhere_none() -> None:
    busy = BusyMachine(3)
    late = [busy.lateness() for _ in range(400)]
    assert 50 < sum(each > 0 for each in late) < 150
    assert BusyMachine.LATEST / 2 < max(late) < BusyMachine.LATEST
    assert not any(schedule_of(seed).lateness() for seed in (0, 3, "pct:3", "random:3", "moves:3=1"))


def test_a_busy_machine_stalls_a_few_times_where_pools_race_and_elsewhere_never() -> None:
    for seed in range(1, 60):
        schedule = BusyMachine(seed)
        stalls = [stall for _ in range(10**5) if (stall := schedule.stall())]
        assert bool(stalls) == schedule.races()
        assert len(stalls) <= BusyMachine.MOST_STALLS
        assert all(stall <= BusyMachine.LONGEST_STALL for stall in stalls)
    for other in (0, 4, "pct:4", "random:4", "moves:3=1", "ask:"):
        assert not any(schedule_of(other).stall() for _ in range(10**3))
