"""What generated systems say on the model is decided, and the same on real rclpy."""

import sys

import pytest

from tests.conformance.comparing import GAP, Case, Outcome, Result, cases, decided, on_model, outcome
from tests.conformance.drawing import drawn
from tests.conformance.programs import program
from tests.conformance.recorded import against_recorded
from tests.conformance.running import run_all
from tests.conformance.searching import Search
from tests.conformance.steered import Steering
from tests.conformance.systems import Callback, System
from tests.real.programs import needs_ros

JAZZY = "jazzy@7.1.5"


def test_the_model_gives_what_real_ros_2_gave() -> None:
    compared = against_recorded(searched=False)
    assert [(kept.distro, kept.seed) for kept, came in compared if came.outcome is not Outcome.SAME] == []


@pytest.mark.slow
def test_the_model_comes_to_other_orders_that_real_ros_2_took() -> None:
    compared = against_recorded(searched=True)
    assert [
        (kept.distro, kept.seed)
        for kept, came in compared
        if not (came.outcome is Outcome.SAME if kept.moves else Search(came, kept.distro).finds(kept.runs))
    ] == []


@pytest.mark.slow
def test_a_system_that_is_decided_says_the_same_on_the_model_each_time() -> None:
    given = cases(2, seed=3, distro=JAZZY)
    again = on_model([each.system for each in given], JAZZY)
    assert [case.model.words for case in given] == [said and said.words for said in again]


@pytest.mark.slow
@pytest.mark.parametrize("seed", ["1723-164", "1725-55"])
def test_a_system_ends_at_no_moment_of_its_own(seed: str) -> None:
    (case,) = decided([(seed, drawn(seed))], JAZZY, fewest_lines=1)
    assert min(abs(moment - case.system.end) for moment in case.model.moments) >= GAP / 2


@pytest.mark.bulk
def test_an_order_that_threads_can_come_to_is_found_and_another_one_is_not() -> None:
    case = next(each for each in cases(12, seed=5, distro=JAZZY) if each.system.executors == (4,))
    for number in range(60):
        moved = next(on_model([case.system], JAZZY, [Steering((*[0] * number, 1))]))
        assert moved is not None
        found = Result(case, outcome(case, [moved]), (moved,))
        if found.outcome is Outcome.ORDER:
            break
    assert found.outcome is Outcome.ORDER
    assert Search(found, JAZZY).finds(240)
    first, second, *rest = case.model.words
    backwards = case.model._replace(words=(second, first, *rest))
    assert not Search(Result(case, Outcome.ORDER, (backwards,)), JAZZY).finds(48)


@pytest.mark.bulk
def test_an_order_that_real_ros_2_took_is_found_where_one_place_of_some_hundred_gives_it() -> None:
    # Jazzy 7.1.5, 1 run of 4: the second goal is accepted before a task of the first one begins.
    (case,) = decided([("1720-35", drawn("1720-35"))], JAZZY)
    *before, waits, accepted, first, second = case.model.words
    assert [waits, accepted] == ["wait_3 #1 waits", "goal_0_3 #2 is accepted"]
    real = case.model._replace(words=(*before, accepted, waits, first, second))
    assert Search(Result(case, Outcome.ORDER, (real,)), JAZZY).finds(240)


@pytest.mark.bulk
def test_an_order_that_real_ros_2_took_is_found_where_a_goal_is_aborted_while_others_go_on() -> None:
    # Jazzy 7.1.5, 10 runs of 16: the goal that was sent first is executed first, and aborted last.
    (case,) = decided([("1720-35", drawn("1720-35"))], JAZZY)
    first, rest = case.model.words[:5], case.model.words[5:]
    goes_on = [rest[place] for place in (1, 4, 0, 2, 3, 5)]
    assert [*goes_on[:2], *rest[-2:]] == [
        "action_3 #1 begins",
        "wait_3 #1 waits",
        "goal_0_3 #1 ends as 4",
        "goal_0_3 #2 ends as 6",
    ]
    real = case.model._replace(words=(*first, *goes_on, "goal_0_3 #2 ends as 4", "goal_0_3 #1 ends as 6"))
    assert Search(Result(case, Outcome.ORDER, (real,)), JAZZY).finds(48)


@pytest.mark.bulk
def test_an_order_that_real_ros_2_took_is_found_where_a_wait_ends_with_what_came_first() -> None:
    # Jazzy 7.1.5: the executor's wait is over when the second goal is accepted, before what that one sends.
    (case,) = decided([("1717-176", drawn("1717-176"))], JAZZY)
    first, rest = case.model.words[:9], case.model.words[9:]
    assert first[-1] == "client_6_2 #1 awaits"
    goes_on = (3, 4, 0, 1, 2, 5, 6, 9, 7, 8, 10, 11, 12)
    real = case.model._replace(words=(*first, *(rest[place] for place in goes_on)))
    assert Search(Result(case, Outcome.ORDER, (real,)), JAZZY).finds(48)


@pytest.mark.bulk
def test_an_order_that_real_ros_2_took_is_found_where_an_executor_goes_ahead_of_its_workers() -> None:
    # Kilted 9.1.2, 3 runs of 10, with the last two the other way round 2 more.
    (case,) = decided([("1718-17", drawn("1718-17"))], "kilted@9.1.2")
    words, times = case.model.words, case.model.times
    moved = (16, 15, 14, 21, 19, 20, 22, 23, 24, 25, 17, 18)
    real = case.model._replace(
        words=(*words[:14], *(words[place] for place in moved), *words[26:]),
        times=(*times[:19], times[20], *times[22:24], *times[22:]),
    )
    assert Search(Result(case, Outcome.ORDER, (real,)), "kilted@9.1.2").finds(120)


@pytest.mark.slow
def test_a_sleep_may_end_between_a_copy_of_the_tasks_and_the_gathering_of_a_pool_that_goes_round() -> None:
    # Jazzy 7.1.5, 1 run of 24.
    steps = (("publish", 1.0), ("sleep", 0.3), ("publish", 1.0), ("task", 0.0))
    timer = Callback(0, "timer", 0, 1, 0.6, 1, (steps,))
    subscription = Callback(1, "subscription", 0, 1, 1.0, 10, ())
    system = System((1,), (0,), ("default", "reentrant"), (timer, subscription), 1.1)
    usual = next(on_model([system], JAZZY))
    assert usual is not None
    *before, task, begins, ends = usual.words
    assert [task, begins] == ["task_0 #1 runs", "subscription_1 #2 begins takes 2"]
    other = usual._replace(words=(*before, begins, ends, task))
    assert Search(Result(Case("", system, usual), Outcome.ORDER, (other,)), JAZZY).finds(60)


@needs_ros
@pytest.mark.slow
def test_every_generated_program_runs_on_real_rclpy() -> None:
    assert all(run_all([program(drawn(f"3-{each}")) for each in range(4)], sys.executable, 4))
