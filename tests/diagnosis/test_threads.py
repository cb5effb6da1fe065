"""Threads and groups that make no difference are remarked on, and never a problem."""

from pathlib import Path

import pytest

from sim.diagnosis import diagnose
from sim.ros.node.node import Node
from sim.ros.scheduling.callback_groups import (
    CallbackGroup,
    MutuallyExclusiveCallbackGroup,
    ReentrantCallbackGroup,
)
from sim.ros.scheduling.executors import MultiThreadedExecutor
from tests.diagnosis.findings import Diagnosed, SetBool, diagnosed, executor_of, spin
from tests.support.engine_runs import run_program
from tests.support.simulation import Simulation


def two_timers(
    groups: tuple[CallbackGroup | None, CallbackGroup | None],
    threads: int | None,
    nodes: tuple[str, str] = ("n", "n"),
) -> Diagnosed:
    """Two callbacks that would run at the same time for a tenth of a second."""

    def program(simulation: Simulation) -> None:
        made = {name: Node(name) for name in nodes}

        def work() -> None:
            simulation.sleep(0.1)

        for name, group in zip(nodes, groups, strict=True):
            made[name].create_timer(1.0, work, group)
        executor = executor_of(threads)
        for node in made.values():
            executor.add_node(node)
        executor.spin()

    return diagnosed(program, until=5.0)


def rules(run: Diagnosed) -> list[str]:
    assert run.problems() == set()
    return [each.rule.id for each in run.findings]


def two_groups() -> tuple[CallbackGroup, CallbackGroup]:
    return MutuallyExclusiveCallbackGroup(), MutuallyExclusiveCallbackGroup()


def test_more_threads_than_groups_are_remarked_on() -> None:
    run = two_timers(two_groups(), threads=4)
    assert rules(run) == ["threads-never-used"]
    told = run.explained("threads-never-used").what
    assert told == "no more than 2 of 4 threads can run callbacks at once: there are 2 groups"


def test_a_run_that_needed_few_threads_does_not_say_how_many_another_one_needs() -> None:
    assert rules(two_timers((ReentrantCallbackGroup(), None), threads=4)) == []


def test_threads_are_not_counted_where_calls_need_them_for_their_done_callbacks() -> None:
    def program(_: Simulation) -> None:
        node = Node("n")
        node.create_service(SetBool, "/serve", lambda request, response: response)
        client = node.create_client(SetBool, "/serve", callback_group=ReentrantCallbackGroup())
        node.create_timer(1.0, lambda: client.call_async(SetBool.Request()), MutuallyExclusiveCallbackGroup())
        spin(node, 4)

    assert rules(diagnosed(program, until=5.0)) == []


def test_threads_of_an_executor_are_not_judged_by_those_of_others() -> None:
    def program(simulation: Simulation) -> None:
        executors = executor_of(4), executor_of(None)
        for place, executor in enumerate(executors):
            node = Node(f"n{place}")
            node.create_timer(1.0, lambda: simulation.sleep(0.1))
            executor.add_node(node)
        simulation.start(executors[0].spin)
        executors[1].spin()

    assert rules(diagnosed(program, until=5.0)) == []


def test_as_many_threads_as_needed_are_well() -> None:
    assert rules(two_timers(two_groups(), threads=2)) == []


def test_threads_change_nothing_where_all_callbacks_share_a_group() -> None:
    run = two_timers((None, None), threads=4)
    assert rules(run) == ["groups-change-nothing"]
    told = run.explained("groups-change-nothing").what
    assert told == "4 threads change nothing: all callbacks share group A"


def test_the_shared_group_is_told_with_the_line_that_puts_the_first_callback_into_it(tmp_path: Path) -> None:
    source = (
        "import rclpy\nfrom rclpy.executors import MultiThreadedExecutor\nrclpy.init()\n"
        "def tick():\n    pass\n"
        "node = rclpy.create_node('n')\nnode.create_timer(0.5, tick)\nnode.create_timer(0.5, tick)\n"
        "executor = MultiThreadedExecutor(4)\nexecutor.add_node(node)\nexecutor.spin()\n"
    )
    timeline = run_program(tmp_path, source, seconds=2).timeline
    (found,) = (each for each in diagnose(timeline) if each.rule.id == "groups-change-nothing")
    assert str(found.explained(timeline).place) == "node.py:7"


def test_threads_change_something_where_calls_may_have_done_callbacks_which_are_in_no_group() -> None:
    def program(_: Simulation) -> None:
        node = Node("n")
        node.create_client(SetBool, "lamp")
        node.create_timer(1.0, lambda: None)
        node.create_timer(1.0, lambda: None)
        spin(node, 2)

    assert rules(diagnosed(program, until=5.0)) == []


def test_threads_change_something_where_the_timer_of_a_rate_is_in_a_group_beside_that_of_all_others() -> None:
    def program(_: Simulation) -> None:
        node = Node("n")
        rate = node.create_rate(5.0)
        node.create_timer(1.0, lambda: rate.sleep())  # noqa: PLW0108 - a callback of its own
        node.create_timer(1.0, lambda: None)
        spin(node, 2)

    assert rules(diagnosed(program, until=5.0)) == []


def test_groups_change_nothing_where_there_is_one_thread() -> None:
    run = two_timers(two_groups(), threads=None)
    assert rules(run) == ["groups-change-nothing"]
    told = run.explained("groups-change-nothing").what
    assert told == "groups A and B change nothing: there is only one thread"


@pytest.mark.filterwarnings("ignore:MultiThreadedExecutor is used with a single thread")
def test_a_reentrant_group_changes_nothing_where_there_is_one_thread() -> None:
    group = ReentrantCallbackGroup()
    run = two_timers((group, group), threads=1)
    assert rules(run) == ["groups-change-nothing"]
    told = run.explained("groups-change-nothing").what
    assert told == "group A changes nothing: there is only one thread"


def test_the_default_groups_of_several_nodes_are_nobodys_choice() -> None:
    assert rules(two_timers((None, None), threads=None, nodes=("a", "b"))) == []


def test_the_group_of_a_rate_is_nobodys_choice() -> None:
    def program(_: Simulation) -> None:
        node = Node("n")
        node.create_timer(1.0, lambda: None)
        node.create_rate(5.0)
        spin(node, None)

    assert rules(diagnosed(program, until=5.0)) == []


def test_the_threads_of_an_executor_that_never_spins_are_not_counted() -> None:
    def program(_: Simulation) -> None:
        node = Node("n")
        node.create_timer(1.0, lambda: None)
        node.create_timer(1.0, lambda: None)
        node.executor = MultiThreadedExecutor(2)
        spin(node, None)

    assert rules(diagnosed(program, until=5.0)) == []


def test_one_thread_and_the_default_group_are_well() -> None:
    assert rules(two_timers((None, None), threads=None)) == []


def test_groups_matter_on_one_thread_where_a_callback_awaits_in_one() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        client = node.create_client(SetBool, "/serve")
        node.create_service(SetBool, "/serve", lambda request, response: response)

        async def ask() -> None:
            await client.call_async(SetBool.Request())

        node.create_timer(1.0, ask, MutuallyExclusiveCallbackGroup())
        spin(node, None)

    assert rules(diagnosed(program, until=5.0)) == []
