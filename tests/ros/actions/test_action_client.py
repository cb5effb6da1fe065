"""Action clients, against an action server and against plain services that stand in for one."""

from typing import Any

import pytest

import sim.ros.rclpy as rclpy
from sim.interfaces import action, message
from sim.ros.actions import ActionClient, ActionServer, CancelResponse
from sim.ros.actions.client import ClientGoalHandle
from sim.ros.actions.server import ServerGoalHandle
from sim.ros.node.node import Node
from sim.ros.rclpy import executors
from sim.ros.scheduling.callback_groups import ReentrantCallbackGroup
from sim.ros.scheduling.events_executor import EventsExecutor
from sim.ros.scheduling.executors import Executor, MultiThreadedExecutor, SingleThreadedExecutor
from sim.ros.scheduling.task import Future
from sim.trace.events import CallBlocked, CallUnblocked, MessageDropped, ServiceCalled
from tests.support.builder import ns
from tests.support.simulation import Simulation, simulate

Fibonacci = action("example_interfaces", "Fibonacci")
Impl = Fibonacci.Impl
GoalStatus = message("action_msgs", "GoalStatus")
Empty = message("std_msgs", "Empty")
UUID = message("unique_identifier_msgs", "UUID")


class Counter(ActionServer):
    """Counts up to the order, one a second, and can be cancelled; the executor has its threads."""

    def __init__(self, simulation: Simulation, node: Node, threads: int = 3, **options: Any) -> None:
        self.simulation = simulation
        options.setdefault("cancel_callback", lambda _: CancelResponse.ACCEPT)
        group = ReentrantCallbackGroup()
        super().__init__(node, Fibonacci, "count", self.count, callback_group=group, **options)
        executor = MultiThreadedExecutor(threads, context=node.context)
        executor.add_node(node)
        simulation.start(executor.spin, "server")

    def count(self, goal_handle: ServerGoalHandle) -> Any:
        result = Fibonacci.Result()
        for number in range(goal_handle.request.order):
            if goal_handle.is_cancel_requested:
                goal_handle.canceled()
                return result
            result.sequence = [*result.sequence, number]
            goal_handle.publish_feedback(Fibonacci.Feedback(sequence=[number]))
            self.simulation.sleep(1.0)
        goal_handle.succeed()
        return result


def finish(node: Node, future: Future[Any], seconds: float = 30.0) -> Any:
    rclpy.spin_until_future_complete(node, future, timeout_sec=seconds)
    assert future.done()
    return future.result()


def spin_for(node: Node, seconds: float) -> None:
    rclpy.spin_until_future_complete(node, Future(), timeout_sec=seconds)


def test_a_goal_is_accepted_followed_and_has_a_result() -> None:
    def program(simulation: Simulation) -> None:
        Counter(simulation, Node("server"))
        node = Node("n")
        client = ActionClient(node, Fibonacci, "count")
        heard: list[tuple[float, list[int]]] = []
        goal_handle = finish(
            node,
            client.send_goal_async(
                Fibonacci.Goal(order=3),
                feedback_callback=lambda message: heard.append(
                    (simulation.now, list(message.feedback.sequence))
                ),
            ),
        )
        assert isinstance(goal_handle, ClientGoalHandle)
        assert goal_handle.accepted
        assert goal_handle.stamp == node.get_clock().now().to_msg()
        response = finish(node, goal_handle.get_result_async())
        assert simulation.now == 3.0
        assert response.status == GoalStatus.STATUS_SUCCEEDED
        assert list(response.result.sequence) == [0, 1, 2]
        assert heard == [(0.0, [0]), (1.0, [1]), (2.0, [2])]
        assert goal_handle.status == GoalStatus.STATUS_SUCCEEDED

    simulate(program)


def test_the_status_of_a_goal_follows_what_the_server_tells() -> None:
    def program(simulation: Simulation) -> None:
        Counter(simulation, Node("server"))
        node = Node("n")
        goal_handle = finish(
            node, ActionClient(node, Fibonacci, "count").send_goal_async(Fibonacci.Goal(order=2))
        )
        spin_for(node, 0.5)
        assert goal_handle.status == GoalStatus.STATUS_EXECUTING
        finish(node, goal_handle.cancel_goal_async())
        spin_for(node, 0.1)
        assert goal_handle.status == GoalStatus.STATUS_CANCELING
        spin_for(node, 1.0)
        assert goal_handle.status == GoalStatus.STATUS_CANCELED

    simulate(program)


def test_cancelling_tells_which_goals_stop() -> None:
    def program(simulation: Simulation) -> None:
        Counter(simulation, Node("server"))
        node = Node("n")
        client = ActionClient(node, Fibonacci, "count")
        first, second = (finish(node, client.send_goal_async(Fibonacci.Goal(order=9))) for _ in range(2))
        assert first != second
        cancel = finish(node, first.cancel_goal_async())
        assert [info.goal_id for info in cancel.goals_canceling] == [first.goal_id]
        response = finish(node, first.get_result_async())
        assert response.status == GoalStatus.STATUS_CANCELED
        spin_for(node, 0.1)
        assert second.status == GoalStatus.STATUS_EXECUTING

    simulate(program)


def test_blocking_calls_wait_on_their_thread_and_are_seen_to() -> None:
    def program(simulation: Simulation) -> None:
        Counter(simulation, Node("server"))
        node = Node("n")
        client = ActionClient(node, Fibonacci, "count")
        simulation.start(lambda: rclpy.spin(node), "spinner")
        heard: list[Any] = []
        response = client.send_goal(Fibonacci.Goal(order=2), feedback_callback=heard.append)
        assert (simulation.now, response.status) == (2.0, GoalStatus.STATUS_SUCCEEDED)
        assert len(heard) == 2
        goal_handle = _wait(simulation, client.send_goal_async(Fibonacci.Goal(order=5)))
        assert len(goal_handle.cancel_goal().goals_canceling) == 1
        assert goal_handle.get_result().status == GoalStatus.STATUS_CANCELED

    trace = simulate(program)
    sent = {event.call: event.service.rpartition("/")[2] for event in trace.of(ServiceCalled)}
    blocked = trace.of(CallBlocked)
    assert [sent[event.call] for event in blocked] == ["send_goal", "get_result", "cancel_goal", "get_result"]
    assert [event.call for event in trace.of(CallUnblocked)] == [event.call for event in blocked]


def _wait(simulation: Simulation, future: Future[Any]) -> Any:
    while not future.done():
        simulation.sleep(0.01)
    return future.result()


def test_a_blocking_call_in_a_callback_of_a_single_threaded_executor_hangs() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        Counter(simulation, Node("server"))
        client = ActionClient(node, Fibonacci, "count")
        node.create_timer(1.0, lambda: client.send_goal(Fibonacci.Goal()))
        rclpy.spin(node)

    trace = simulate(program, until=5.0)
    assert len(trace.of(CallBlocked)) == 1
    assert [event.t for event in trace.of(CallUnblocked)] == [ns(5.0)]


def test_what_is_no_goal_or_no_goal_handle_is_refused() -> None:
    def program(simulation: Simulation) -> None:
        client = ActionClient(Node("n"), Fibonacci, "count")
        with pytest.raises(TypeError):
            client.send_goal("different goal type")
        with pytest.raises(TypeError):
            client.send_goal_async(Fibonacci.Result())
        with pytest.raises(TypeError, match="Expected type ClientGoalHandle but received <class 'str'>"):
            client._cancel_goal_async("different goal type")  # type: ignore[arg-type]
        with pytest.raises(TypeError):
            client._get_result_async("different goal type")  # type: ignore[arg-type]

    simulate(program)


def test_a_goal_sent_without_a_server_is_lost() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        future = ActionClient(node, Fibonacci, "count").send_goal_async(Fibonacci.Goal())
        Counter(simulation, Node("server"))
        spin_for(node, 2.0)
        assert not future.done()

    simulate(program)


def test_a_server_is_awaited_for_as_long_as_wanted() -> None:
    def program(simulation: Simulation) -> None:
        client = ActionClient(Node("n"), Fibonacci, "count")
        assert not client.wait_for_server(timeout_sec=0.0)
        assert simulation.now == 0.0
        assert not client.wait_for_server(timeout_sec=1.0)
        assert simulation.now == 1.0
        server = Node("server")
        simulation.at(2.1, lambda: ActionServer(server, Fibonacci, "count", lambda _: None))
        assert client.wait_for_server()
        assert simulation.now == 2.25

    simulate(program)


def test_a_server_is_ready_once_all_its_services_and_topics_are_there() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        client = ActionClient(node, Fibonacci, "count")

        def serve(_request: Any, response: Any) -> Any:
            return response

        for kind, part in (
            (Impl.SendGoalService, "send_goal"),
            (Impl.CancelGoalService, "cancel_goal"),
            (Impl.GetResultService, "get_result"),
        ):
            node.create_service(kind, f"/count/_action/{part}", serve)
        node.create_publisher(Impl.FeedbackMessage, "/count/_action/feedback", 1)
        assert not client.server_is_ready()
        node.create_publisher(Impl.GoalStatusMessage, "/count/_action/status", 1)
        assert client.server_is_ready()

    simulate(program)


def test_feedback_reaches_only_the_callback_of_its_own_goal() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        client = ActionClient(node, Fibonacci, "count")

        def accept(_request: Any, response: Any) -> Any:
            response.accepted = True
            return response

        node.create_service(Impl.SendGoalService, "/count/_action/send_goal", accept)
        publisher = node.create_publisher(Impl.FeedbackMessage, "/count/_action/feedback", 1)
        heard: dict[int, list[Any]] = {1: [], 2: []}
        publisher.publish(Impl.FeedbackMessage(goal_id=UUID(uuid=[1] * 16)))
        spin_for(node, 0.1)
        for number in (1, 2):
            finish(
                node,
                client.send_goal_async(
                    Fibonacci.Goal(), heard[number].append, goal_uuid=UUID(uuid=[number] * 16)
                ),
            )
        for number in (2, 3):
            publisher.publish(Impl.FeedbackMessage(goal_id=UUID(uuid=[number] * 16)))
            spin_for(node, 0.1)
        assert [len(each) for each in heard.values()] == [0, 1]

    simulate(program)


def test_feedback_that_is_not_taken_in_time_is_dropped_and_counted() -> None:
    def program(simulation: Simulation) -> None:
        Counter(simulation, Node("server"))
        node = Node("n")
        client = ActionClient(node, Fibonacci, "count")
        heard: list[int] = []
        client.send_goal_async(
            Fibonacci.Goal(order=13), lambda message: heard.append(message.feedback.sequence[0])
        )
        simulation.sleep(20.0)
        spin_for(node, 1.0)
        assert heard == list(range(3, 13))

    trace = simulate(program)
    assert len(trace.of(MessageDropped)) == 3


def test_a_status_that_a_newer_one_replaces_is_not_lost() -> None:
    def program(simulation: Simulation) -> None:
        Counter(simulation, Node("server"))
        node = Node("n")
        client = ActionClient(node, Fibonacci, "count")
        client.send_goal_async(Fibonacci.Goal(order=5))
        simulation.sleep(10.0)
        spin_for(node, 1.0)

    assert not simulate(program).of(MessageDropped)


def test_an_answer_nobody_waits_for_is_ignored_with_a_warning() -> None:
    def program(simulation: Simulation) -> None:
        Counter(simulation, Node("server"))
        node = Node("n")
        client = ActionClient(node, Fibonacci, "count")
        client.send_goal_async(Fibonacci.Goal()).cancel()
        simulation.sleep(1.0)
        spin_for(node, 1.0)

    assert simulate(program).said() == [
        "Ignoring unexpected goal response. There may be more than one action server for the action 'count'"
    ]


def test_goals_of_different_clients_never_share_an_id() -> None:
    def program(simulation: Simulation) -> None:
        Counter(simulation, Node("server"), threads=5)
        ids = set()
        for number in range(3):
            node = Node("n") if number else simulation.outside_node("n")
            client = ActionClient(node, Fibonacci, "count")
            for _ in range(3):
                goal_handle = _spun(simulation, node, client.send_goal_async(Fibonacci.Goal()))
                assert goal_handle.accepted
                ids.add(bytes(goal_handle.goal_id.uuid))
        assert len(ids) == 9
        simulation.sleep(0.1)  # until the last goal has run, too

    simulate(program)


def _spun(simulation: Simulation, node: Node, future: Future[Any]) -> Any:
    executor = executors.SingleThreadedExecutor(context=node.context)
    executor.add_node(node)
    executor.spin_until_future_complete(future)
    executor.remove_node(node)
    return future.result()


def test_a_destroyed_client_hears_nothing_more() -> None:
    def program(simulation: Simulation) -> None:
        Counter(simulation, Node("server"))
        node = Node("n")
        client = ActionClient(node, Fibonacci, "count")
        future = client.send_goal_async(Fibonacci.Goal())
        client.destroy()
        client.destroy()
        spin_for(node, 1.0)
        assert not future.done()
        assert node.count_clients("/count/_action/send_goal") == 0
        assert node.count_subscribers("/count/_action/feedback") == 0

    simulate(program)


def test_a_client_counts_its_entities() -> None:
    def program(simulation: Simulation) -> None:
        counts = ActionClient(Node("n"), Fibonacci, "count").get_num_entities()
        assert (counts.num_clients, counts.num_subscriptions) == (3, 2)
        assert (counts.num_services, counts.num_timers, counts.num_guard_conditions) == (0, 0, 0)

    simulate(program)


def test_a_coroutine_callback_may_await_a_whole_goal() -> None:
    def program(simulation: Simulation) -> None:
        Counter(simulation, Node("server"))
        node = Node("n")
        client = ActionClient(node, Fibonacci, "count", callback_group=ReentrantCallbackGroup())
        done: Future[Any] = Future()

        async def ask() -> None:
            timer.cancel()
            goal_handle = await client.send_goal_async(Fibonacci.Goal(order=2))
            assert goal_handle is not None
            done.set_result(await goal_handle.get_result_async())

        timer = node.create_timer(1.0, ask)
        assert finish(node, done).status == GoalStatus.STATUS_SUCCEEDED
        assert simulation.now == 3.0

    simulate(program)


@pytest.mark.parametrize("kind", [SingleThreadedExecutor, EventsExecutor])
def test_a_client_takes_what_was_there_when_its_executor_looked_and_nothing_that_came_since(
    kind: type[Executor],
) -> None:
    # Measured on Jazzy 7.1.5 and Kilted 9.1.2: six runs of six with each executor.
    said: list[str] = []

    def program(_simulation: Simulation) -> None:
        node = Node("n")
        goals: list[ServerGoalHandle] = []

        def accept(goal: ServerGoalHandle) -> None:
            goals.append(goal)
            if len(goals) == 2:
                publisher.publish(Empty())

        def send() -> None:
            hear = client.send_goal_async(Fibonacci.Goal(), feedback_callback=lambda _: said.append("hears"))
            hear.add_done_callback(lambda _: said.append("accepted"))

        def send_another() -> None:
            timer.cancel()
            goals[0].publish_feedback(Fibonacci.Feedback())
            send()

        publisher = node.create_publisher(Empty, "t", 10)
        node.create_subscription(Empty, "t", lambda _: said.append("arrived"), 10)
        ActionServer(node, Fibonacci, "f", lambda _: None, handle_accepted_callback=accept)
        client = ActionClient(node, Fibonacci, "f")
        timer = node.create_timer(0.3, send_another)
        executor = kind()
        executor.add_node(node)
        send()
        executor.spin()

    simulate(program, until=0.5)
    assert said == ["accepted", "hears", "arrived", "accepted"]


@pytest.mark.parametrize(
    ("kind", "order"),
    [
        (SingleThreadedExecutor, ["1 at work", "hears", "1 accepted", "2 at work", "2 accepted"]),
        (EventsExecutor, ["1 at work", "1 accepted", "hears", "2 at work", "2 accepted"]),
    ],
)
def test_an_events_executor_has_a_client_take_from_one_part_for_each_arrival(
    kind: type[Executor], order: list[str]
) -> None:
    # Measured on Jazzy 7.1.5, three runs of three with each executor.
    said: list[str] = []

    def program(_simulation: Simulation) -> None:
        node = Node("n")

        def execute(goal: ServerGoalHandle) -> Any:
            said.append(f"{goal.request.order} at work")
            if goal.request.order == 1:
                send(2)
                goal.publish_feedback(Fibonacci.Feedback())
            goal.succeed()
            return Fibonacci.Result()

        def send(number: int) -> None:
            goal = Fibonacci.Goal(order=number)
            hear = client.send_goal_async(goal, feedback_callback=lambda _: said.append("hears"))
            hear.add_done_callback(lambda _: said.append(f"{number} accepted"))

        ActionServer(node, Fibonacci, "f", execute)
        client = ActionClient(node, Fibonacci, "f")
        executor = kind()
        executor.add_node(node)
        send(1)
        executor.spin()

    simulate(program, until=0.5)
    assert said == order
