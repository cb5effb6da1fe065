"""Subscriptions that cause their own calls, by what they publish."""

from typing import Any

import pytest

from sim.quantities.nanoseconds import SECOND
from sim.ros.node.node import Node
from sim.trace.model import Nanoseconds, Window
from tests.diagnosis.findings import Diagnosed, Int32, diagnosed, spin
from tests.support.simulation import Simulation

ROUNDS = 300


def relay(
    topics: list[str], pause: Nanoseconds = 0, back: str = "", copies: int = 1, rounds: int = ROUNDS
) -> Diagnosed:
    """A timer, and subscriptions that send on what they hear, the last to the first topic or elsewhere."""

    def program(simulation: Simulation) -> None:
        node = Node("n")
        publishers = [node.create_publisher(Int32, each, 10) for each in [*topics, back or topics[0]]]

        def hear(place: int, message: Any) -> None:
            simulation.clock.sleep(pause)
            for _ in range(copies if message.data < rounds else 0):
                publishers[place + 1].publish(Int32(data=message.data + 1))

        def hear_first(message: Any) -> None:
            hear(0, message)

        def hear_second(message: Any) -> None:
            hear(1, message)

        for topic, callback in zip(topics, (hear_first, hear_second), strict=False):
            node.create_subscription(Int32, topic, callback, 10)

        def tick() -> None:
            publishers[0].publish(Int32(data=1))

        node.create_timer(0.5, tick)
        spin(node, None)

    return diagnosed(program, 4.0)


def test_a_subscription_that_hears_its_own_messages_is_told() -> None:
    told = relay(["/n"]).explained("feedback-loop")
    assert (
        told.what
        == "hear_first hears its own messages on /n: 200 calls in a row led to one another at one moment"
    )
    assert told.cure == "publish on another topic than hear_first hears, or only what has changed"


def test_so_are_two_that_call_each_other_as_one_problem() -> None:
    told = relay(["/ping", "/pong"]).explained("feedback-loop")
    assert told.what.startswith("hear_first and hear_second hear their own messages on /ping and /pong: 200 ")


def test_a_loop_is_dated_by_its_begin_however_long_it_lasts() -> None:
    found = relay(["/n"], SECOND // 2000, rounds=10 * ROUNDS).one("feedback-loop")
    assert found.at == SECOND // 2
    assert found.until > 3 * SECOND


@pytest.mark.parametrize("topics", [["/n"], ["/ping", "/pong"]])
def test_what_a_loop_loses_by_itself_is_no_other_problem(topics: list[str]) -> None:
    run = relay(topics, copies=3)
    assert sum(run.timeline.drops_of(each, Window(0, run.timeline.end + 1)) for each in run.timeline.entities)
    assert run.problems() == {("feedback-loop", "hear_first")}


@pytest.mark.parametrize(("pause", "back"), [(SECOND // 100, ""), (0, "/elsewhere")])
def test_a_loop_with_a_rest_and_a_chain_with_an_end_are_not(pause: Nanoseconds, back: str) -> None:
    assert not [each for each in relay(["/n"], pause, back).findings if each.rule.id == "feedback-loop"]
