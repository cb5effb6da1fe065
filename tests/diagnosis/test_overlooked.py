"""What a program makes nothing of: a future's result before there is one, and the refusal of a parameter."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from sim.interfaces import message
from sim.ros.node.node import Node
from sim.ros.parameters.parameter import Parameter
from tests.diagnosis.findings import Diagnosed, SetBool, diagnosed, once, spin
from tests.support.simulation import Simulation

SetParametersResult = message("rcl_interfaces", "SetParametersResult")
Use = Callable[[Node], object]


def told_of(use: Use, *, calls: int = 2) -> Diagnosed:
    """A node that refuses parameters above 2, offers a service, and does something in each tick."""

    def program(_: Simulation) -> None:
        node = Node("n")
        node.declare_parameter("limit", 1.0)
        node.add_on_set_parameters_callback(
            lambda asked: SetParametersResult(successful=asked[0].value <= 2.0, reason="too fast")
        )
        node.create_service(SetBool, "lamp", lambda _, response: response)

        def tick() -> None:
            use(node)

        for number in range(calls):
            once(node, 1.0 + number, tick)
        spin(node, None)

    return diagnosed(program, until=5.0)


def faster(node: Node, value: float = 3.0) -> None:
    node.set_parameters([Parameter("limit", value=value)])


def faster_at_once(node: Node) -> None:
    node.set_parameters_atomically([Parameter("limit", value=3.0)])


def faster_or_not(node: Node) -> bool:
    (result,) = node.set_parameters([Parameter("limit", value=3.0)])
    return bool(result.successful)


@pytest.mark.parametrize("use", [faster, faster_at_once])
def test_a_refused_parameter_is_told_if_the_answer_is_dropped(use: Use) -> None:
    run = told_of(use)
    assert run.problems() == set()
    told = run.explained("answer-overlooked")
    assert told.what == ("tick does not look at what set_parameters() returns: limit was refused: too fast")
    assert told.place is not None
    assert "set_parameters" in Path(told.place.file).read_text().splitlines()[told.place.first_line - 1]


@pytest.mark.parametrize("use", [faster_or_not, lambda node: faster(node, 1.5)], ids=["looks", "not refused"])
def test_an_answer_that_is_looked_at_or_refuses_nothing_is_well(use: Use) -> None:
    assert told_of(use).told() == set()


def early(node: Node) -> object:
    future = node.create_client(SetBool, "lamp").call_async(SetBool.Request())
    return future.result()


def test_a_result_that_is_asked_for_as_soon_as_the_request_is_sent_is_told_with_its_line() -> None:
    run = told_of(early)
    assert run.problems() == set()
    told = run.explained("answer-overlooked")
    assert told.what == "tick asks a future for its result() as soon as the request is sent: that is None"
    assert told.cure.startswith("use the result in a done-callback, by future.add_done_callback(), or await")
    assert told.place is not None
    line = Path(told.place.file).read_text().splitlines()[told.place.first_line - 1]
    assert line.strip() == "return future.result()"


def test_a_result_that_a_later_callback_asks_for_is_well_though_it_may_not_be_there() -> None:
    futures: list[Any] = []

    def poll(node: Node) -> None:
        if futures:
            futures.pop().result()
        futures.append(node.create_client(SetBool, "nobody").call_async(SetBool.Request()))

    assert "answer-overlooked" not in {rule for rule, _ in told_of(poll).told()}
