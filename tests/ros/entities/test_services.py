"""Services: requests, replies, and what goes wrong between them."""

from collections.abc import Callable
from itertools import permutations
from typing import Any

import pytest

import sim.ros.rclpy as rclpy
from sim.clock.strategies import RandomWalk
from sim.interfaces import service
from sim.ros.exceptions import InvalidHandle
from sim.ros.node.node import Node
from sim.ros.scheduling.executors import SingleThreadedExecutor
from sim.trace.events import MessageDropped, ServiceCalled, ServiceReplied
from tests.support.simulation import Simulation, simulate

SetBool = service("std_srvs", "SetBool")
Trigger = service("std_srvs", "Trigger")


def test_a_service_gets_a_copy_of_the_request_and_the_caller_a_copy_of_the_response() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        kept: list[object] = []

        def serve(request: object, response: object) -> object:
            assert request.data  # type: ignore[attr-defined]
            response.message = "served"  # type: ignore[attr-defined]
            kept.append(response)
            return response

        node.create_service(SetBool, "s", serve)
        request = SetBool.Request(data=True)
        future = node.create_client(SetBool, "s").call_async(request)
        request.data = False
        rclpy.spin_until_future_complete(node, future)
        kept[0].message = "spoilt"  # type: ignore[attr-defined]
        reply: Any = future.result()
        assert reply.message == "served"

    trace = simulate(program)
    (call,), (reply,) = trace.of(ServiceCalled), trace.of(ServiceReplied)
    assert call.call == reply.call
    assert call.request == "std_srvs.srv.SetBool_Request(data=True)"
    assert "message='served'" in reply.response


def test_a_request_sent_before_the_server_exists_is_lost() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        future = node.create_client(SetBool, "s").call_async(SetBool.Request())
        node.create_service(SetBool, "s", lambda _, response: response)
        rclpy.spin_until_future_complete(node, future, timeout_sec=5.0)
        assert not future.done()

    simulate(program)


def test_a_service_of_another_type_is_not_reached() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_service(Trigger, "s", lambda _, response: response)
        client = node.create_client(SetBool, "s")
        assert not client.service_is_ready()
        future = client.call_async(SetBool.Request())
        rclpy.spin_until_future_complete(node, future, timeout_sec=5.0)
        assert not future.done()

    simulate(program)


def test_a_callback_that_raises_sends_no_reply() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")

        def serve(_request: object, _response: object) -> object:
            raise ValueError("broken")

        node.create_service(SetBool, "s", serve)
        future = node.create_client(SetBool, "s").call_async(SetBool.Request())
        with pytest.raises(ValueError, match=r"^broken$"):
            rclpy.spin(node)
        rclpy.spin_until_future_complete(node, future, timeout_sec=5.0)
        assert not future.done()

    assert simulate(program).of(ServiceReplied) == []


@pytest.mark.parametrize("wrong", [None, True, Trigger.Response(), SetBool.Request()])
def test_a_callback_that_returns_no_response_of_the_type_is_a_type_error(wrong: object) -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_service(SetBool, "s", lambda *_: wrong)
        node.create_client(SetBool, "s").call_async(SetBool.Request())
        with pytest.raises(TypeError) as caught:
            rclpy.spin(node)
        assert str(caught.value) == f"Expected {SetBool.Response}, got {type(wrong)}"

    assert simulate(program).of(ServiceReplied) == []


def test_a_service_type_itself_cannot_be_made() -> None:
    with pytest.raises(NotImplementedError):
        SetBool()


def test_a_service_keeps_ten_requests_and_answers_them_in_order() -> None:
    answered: list[int] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_service(SetBool, "s", lambda _, response: response)
        client = node.create_client(SetBool, "s")
        for number in range(12):
            client.call_async(SetBool.Request()).add_done_callback(_appending(answered, number))
        rclpy.spin(node)

    trace = simulate(program, until=1.0)
    assert len(trace.of(MessageDropped)) == 2
    assert answered == list(range(2, 12))


def test_replies_reach_the_futures_they_belong_to() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")

        def serve(request: object, response: object) -> object:
            response.success = request.data  # type: ignore[attr-defined]
            return response

        node.create_service(SetBool, "s", serve)
        clients = [node.create_client(SetBool, "s") for _ in range(2)]
        wanted = [True, False, False, True]
        futures = [
            clients[number % 2].call_async(SetBool.Request(data=data)) for number, data in enumerate(wanted)
        ]
        for future in futures:
            rclpy.spin_until_future_complete(node, future)
        replies: list[Any] = [future.result() for future in futures]
        assert [reply.success for reply in replies] == wanted

    simulate(program)


def test_the_reply_to_a_destroyed_client_is_thrown_away() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_service(SetBool, "s", lambda _, response: response)
        client = node.create_client(SetBool, "s")
        future = client.call_async(SetBool.Request())
        node.destroy_client(client)
        rclpy.spin_until_future_complete(node, future, timeout_sec=1.0)
        assert not future.done()

    simulate(program)


def test_a_destroyed_service_is_no_longer_offered() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        server = node.create_service(SetBool, "s", lambda _, response: response)
        client = node.create_client(SetBool, "s")
        assert client.service_is_ready()
        assert node.destroy_service(server)
        assert not client.service_is_ready()

    simulate(program)


def _appending(to: list[int], number: int) -> Callable[[object], None]:
    return lambda _: to.append(number)


def test_a_service_that_its_own_callback_destroyed_cannot_answer() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")

        def serve(_: Any, response: Any) -> Any:
            node.destroy_service(served)
            return response

        served = node.create_service(SetBool, "s", serve)
        future = node.create_client(SetBool, "s").call_async(SetBool.Request())
        with pytest.raises(InvalidHandle):
            rclpy.spin(node)
        assert not future.done()

    simulate(program)


def test_a_reply_makes_all_clients_of_its_service_ready_and_the_others_take_nothing() -> None:
    # Measured on Jazzy 7.1.5 and Kilted 9.1.2: Fast DDS sends a reply to all clients of the service.
    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_service(SetBool, "s", lambda _, response: response)
        clients = [node.create_client(SetBool, "s") for _ in range(2)]
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        future = clients[1].call_async(SetBool.Request())
        executor.spin_once()
        for client in clients:
            assert not future.done()
            take, entity, _ = executor.wait_for_ready_callbacks(timeout_sec=0.1)
            assert entity is client
            take()
        assert future.done()

    simulate(program)


def test_a_service_keeps_one_order_of_the_clients_it_found_which_is_any_where_threads_race() -> None:
    # Fast DDS on Jazzy: replies came to four that were there as 1, 0, 2, 3 each time, whoever had called.
    def arrivals(seed: int, caller: int) -> list[int]:
        came: list[int] = []

        def program(_: Simulation) -> None:
            here, there = Node("here"), Node("there")
            clients: list[Any] = [there.create_client(SetBool, "s") for _ in range(3)]
            here.create_service(SetBool, "s", lambda _, response: response)
            clients.append(there.create_client(SetBool, "s"))
            executor = SingleThreadedExecutor()
            executor.add_node(here)
            clients[caller].call_async(SetBool.Request())
            executor.spin_once()
            came.extend(clients.index(each) for each in there._agenda.ready)

        simulate(program, schedule=RandomWalk(seed))
        return came

    assert all(arrivals(seed, 0) == [0, 1, 2, 3] for seed in range(1, 20, 2))
    assert all(arrivals(seed, 0) == arrivals(seed, 2) for seed in range(0, 10, 2))
    assert {tuple(arrivals(seed, 0)) for seed in range(0, 60, 2)} == {
        (*found, 3) for found in permutations(range(3))
    }


@pytest.mark.parametrize("caller", [0, 1], ids=["of its own calls", "of another client's calls"])
def test_a_client_that_is_not_served_loses_its_oldest_reply_to_the_tenth_after_it(caller: int) -> None:
    # Measured on Jazzy: the reader keeps the last 10 replies of the service, whichever client they are to.
    def program(simulation: Simulation) -> None:
        here, there = Node("here"), Node("there")
        here.create_service(SetBool, "s", lambda _, response: response)
        clients = [there.create_client(SetBool, "s") for _ in range(2)]
        server, waiting = SingleThreadedExecutor(), SingleThreadedExecutor()
        server.add_node(here)
        waiting.add_node(there)
        future = clients[0].call_async(SetBool.Request())
        for _ in range(10):
            server.spin_once()
            clients[caller].call_async(SetBool.Request())
        server.spin_once()
        for _ in range(30):
            waiting.spin_once(timeout_sec=0.01)
        assert not future.done()

    dropped = [event for event in simulate(program).events if isinstance(event, MessageDropped)]
    assert len(dropped) == 1
