"""Callbacks that make entities again and again, and keep them or not."""

from collections.abc import Callable
from itertools import count
from pathlib import Path
from typing import Any

import pytest

from sim.ros.node.node import Node
from tests.diagnosis.findings import Diagnosed, Int32, SetBool, diagnosed, once, spin
from tests.support.simulation import Simulation

Make = Callable[[Node], Any]


def making(make: Make, threads: int | None = None, until: float = 8.0) -> Diagnosed:
    """A timer whose callback makes something by a function, each second."""

    def program(simulation: Simulation) -> None:
        node = Node("n")

        def tick() -> None:
            make(node)

        node.create_timer(1.0, tick)
        spin(node, threads)

    return diagnosed(program, until)


def late() -> None: ...


def line_with(text: str) -> int:
    lines = Path(__file__).read_text().splitlines()
    return next(number for number, line in enumerate(lines, 1) if text in line)


@pytest.mark.parametrize("threads", [None, 2])
def test_a_timer_that_is_made_in_each_call_is_told_with_its_line_and_their_number(
    threads: int | None,
) -> None:
    run = making(lambda node: node.create_timer(1.5, late), threads, until=8.5)
    told = run.explained("never-destroyed")
    line = line_with("node.create_timer(1.5, late), threads")
    assert told.what == (
        f"tick makes a timer at line {line} each time it runs: 8 so far, and none was destroyed"
    )
    assert told.why.startswith("each of them goes on being called")
    assert told.cure == "make it once, in __init__, or destroy_timer() the former one"
    assert str(told.place) == f"test_leaks.py:{line}"


@pytest.mark.parametrize(
    ("make", "kind"),
    [
        (lambda node: node.create_subscription(Int32, "numbers", lambda _: None, 10), "subscription"),
        (lambda node: node.create_client(SetBool, "lamp"), "client"),
        (lambda node: node.create_service(SetBool, "lamp", lambda _, response: response), "service"),
        (lambda node: node.create_publisher(Int32, "numbers", 10), "publisher"),
        (lambda node: node.create_rate(2.0), "rate"),
    ],
)
def test_so_are_other_things_with_their_own_word(make: Make, kind: str) -> None:
    told = making(make).explained("never-destroyed")
    assert told.what.startswith(f"tick makes a {kind} at line ")
    assert told.what.endswith(" each time it runs: 7 so far, and none was destroyed")
    assert told.cure.endswith(f"destroy_{kind}() the former one")


def is_told(run: Diagnosed) -> bool:
    return any(rule == "never-destroyed" for rule, _ in run.told())


def test_four_are_too_few() -> None:
    assert not is_told(making(lambda node: node.create_client(SetBool, "lamp"), until=4.5))
    assert is_told(making(lambda node: node.create_client(SetBool, "lamp"), until=5.5))


def test_a_callback_that_makes_many_in_its_first_call_is_well() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        once(node, 1.0, lambda: [node.create_timer(1.0, late) for _ in range(9)])
        spin(node, None)

    assert not is_told(diagnosed(program))


def test_a_callback_that_destroys_the_former_one_is_well() -> None:
    made: list[Any] = []

    def replace(node: Node) -> None:
        if made:
            node.destroy_timer(made.pop())
        made.append(node.create_timer(0.3, late))

    assert not is_told(making(replace))


def test_a_rate_is_kept_unless_its_node_destroys_it() -> None:
    assert not is_told(making(lambda node: node.destroy_rate(node.create_rate(2.0))))
    assert is_told(making(lambda node: node.create_rate(2.0).destroy()))


def test_timers_that_cancel_themselves_are_well_be_they_many_before_the_first_is_called() -> None:
    def make(node: Node) -> None:
        def only_once() -> None:
            timer.cancel()

        timer = node.create_timer(7.0, only_once)

    assert not is_told(making(make, until=6.5))
    assert not is_told(making(make, until=20.0))


def test_of_publishers_that_are_not_made_in_each_call_the_latest_doubling_is_told() -> None:
    calls = count()

    def seldom(node: Node) -> None:
        if next(calls) % 2:
            node.create_publisher(Int32, "numbers", 10)

    told = making(seldom, until=26.5).explained("never-destroyed")
    assert told.what.endswith(" again and again: 10 so far, and none was destroyed")


def test_publishers_of_many_topics_and_destroyed_ones_are_well() -> None:
    names = (f"robot_{number}" for number in count())
    assert not is_told(making(lambda node: node.create_publisher(Int32, next(names), 10)))
    assert not is_told(
        making(lambda node: node.destroy_publisher(node.create_publisher(Int32, "numbers", 10)))
    )
