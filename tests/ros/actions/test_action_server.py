"""Action servers, asked by plain clients of their services and heard by plain subscriptions."""

from typing import Any

import pytest

from sim.ros.actions.server import ActionServer, GoalResponse, ServerGoalHandle
from sim.ros.exceptions import RCLError
from sim.ros.node.node import Node
from sim.trace.events import CallbackFailed, EntityAppeared, EntityGone
from tests.ros.actions.asker import Asker, Fibonacci, GoalStatus, Int32, spin_for, succeed
from tests.support.simulation import Simulation, simulate


def test_an_accepted_goal_is_executed_and_its_result_is_for_whoever_asks() -> None:
    def program(simulation: Simulation) -> None:
        asker = Asker(Node("n"))
        ActionServer(asker.node, Fibonacci, "fibonacci", succeed)
        accepted = asker.send(1)
        assert accepted.accepted
        assert accepted.stamp == asker.node.get_clock().now().to_msg()
        for _ in range(2):
            response = asker.result(1)
            assert response.status == GoalStatus.STATUS_SUCCEEDED
            assert list(response.result.sequence) == [1, 1, 2]

    simulate(program)


def test_the_goal_callback_sees_the_goal_and_may_refuse_it() -> None:
    def program(simulation: Simulation) -> None:
        asker = Asker(Node("n"))
        begun: list[ServerGoalHandle] = []
        ActionServer(
            asker.node,
            Fibonacci,
            "fibonacci",
            succeed,
            goal_callback=lambda goal: GoalResponse.ACCEPT if goal.order > 5 else GoalResponse.REJECT,
            handle_accepted_callback=begun.append,
        )
        assert not asker.send(1, order=5).accepted
        assert asker.send(2, order=6).accepted
        assert [handle.request.order for handle in begun] == [6]
        assert begun[0].status == GoalStatus.STATUS_ACCEPTED

    simulate(program)


def test_a_goal_callback_that_answers_anything_else_warns_and_refuses() -> None:
    def program(simulation: Simulation) -> None:
        asker = Asker(Node("n"))
        ActionServer(asker.node, Fibonacci, "fibonacci", succeed, goal_callback=lambda _: True)
        assert not asker.send(1).accepted

    said = simulate(program).said()
    assert said == ["Goal request callback did not return a GoalResponse type. Rejecting goal."]


def test_an_id_that_is_in_use_is_refused_without_asking() -> None:
    def program(simulation: Simulation) -> None:
        asker = Asker(Node("n"))
        asked: list[Any] = []

        def accept(goal: Any) -> GoalResponse:
            asked.append(goal)
            return GoalResponse.ACCEPT

        ActionServer(asker.node, Fibonacci, "fibonacci", succeed, goal_callback=accept)
        assert asker.send(1).accepted
        assert not asker.send(1).accepted
        assert len(asked) == 1

    simulate(program)


def test_callbacks_may_be_coroutines() -> None:
    def program(simulation: Simulation) -> None:
        asker = Asker(Node("n"))

        async def accept(_goal: Any) -> GoalResponse:
            return GoalResponse.ACCEPT

        async def begin(goal_handle: ServerGoalHandle) -> None:
            goal_handle.execute()

        async def execute(goal_handle: ServerGoalHandle) -> Any:
            return succeed(goal_handle)

        ActionServer(
            asker.node,
            Fibonacci,
            "fibonacci",
            execute,
            goal_callback=accept,
            handle_accepted_callback=begin,
        )
        assert asker.send(1).accepted
        assert asker.result(1).status == GoalStatus.STATUS_SUCCEEDED

    simulate(program)


def test_a_goal_whose_state_is_not_set_counts_as_aborted() -> None:
    def program(simulation: Simulation) -> None:
        asker = Asker(Node("n"))
        ActionServer(asker.node, Fibonacci, "fibonacci", lambda _: Fibonacci.Result(sequence=[7]))
        asker.send(3)
        response = asker.result(3)
        assert response.status == GoalStatus.STATUS_ABORTED
        assert list(response.result.sequence) == [7]

    said = simulate(program).said()
    assert said == [f"Goal state not set, assuming aborted. Goal ID: [{' '.join('3' * 16)}]"]


def test_an_execute_callback_that_raises_gives_an_empty_result(capsys: pytest.CaptureFixture[str]) -> None:
    def program(simulation: Simulation) -> None:
        asker = Asker(Node("n"))

        def execute(goal_handle: ServerGoalHandle) -> Any:
            goal_handle.succeed()
            raise ValueError("no way")

        ActionServer(asker.node, Fibonacci, "fibonacci", execute)
        asker.send(1)
        response = asker.result(1)
        assert response.status == GoalStatus.STATUS_SUCCEEDED
        assert list(response.result.sequence) == []

    trace = simulate(program)
    assert trace.said() == ["Error raised in execute callback: no way"]
    assert [event.error for event in trace.of(CallbackFailed)] == ["ValueError: no way"]
    assert 'raise ValueError("no way")' in capsys.readouterr().err


def test_an_execute_callback_that_returns_nothing_breaks_the_spin() -> None:
    def program(simulation: Simulation) -> None:
        asker = Asker(Node("n"))
        ActionServer(asker.node, Fibonacci, "fibonacci", lambda goal_handle: goal_handle.succeed())
        with pytest.raises(AssertionError, match="'result' field must be a sub message"):
            asker.send(1)

    simulate(program)


def test_a_result_given_with_the_state_counts() -> None:
    def program(simulation: Simulation) -> None:
        asker = Asker(Node("n"))
        begun: list[ServerGoalHandle] = []
        ActionServer(asker.node, Fibonacci, "fibonacci", handle_accepted_callback=begun.append)
        asker.send(1)
        (goal_handle,) = begun
        goal_handle.execute()
        goal_handle.succeed(Fibonacci.Result(sequence=[4]))
        assert list(asker.result(1).result.sequence) == [4]

    simulate(program)


def test_an_unknown_goal_has_an_unknown_result() -> None:
    def program(simulation: Simulation) -> None:
        asker = Asker(Node("n"))
        ActionServer(asker.node, Fibonacci, "fibonacci", succeed)
        assert asker.result(1).status == GoalStatus.STATUS_UNKNOWN

    simulate(program)


def test_feedback_carries_the_goals_id_and_must_be_of_the_right_type() -> None:
    def program(simulation: Simulation) -> None:
        asker = Asker(Node("n"))

        def execute(goal_handle: ServerGoalHandle) -> Any:
            feedback = Fibonacci.Feedback(sequence=[5])
            goal_handle.publish_feedback(feedback)
            feedback.sequence = [6]
            with pytest.raises(TypeError):
                goal_handle.publish_feedback(Fibonacci.Result())
            return succeed(goal_handle)

        ActionServer(asker.node, Fibonacci, "fibonacci", execute)
        asker.send(9)
        asker.result(9)
        assert asker.feedback == [(9, [5])]

    simulate(program)


def test_the_status_of_all_goals_is_told_at_each_change_and_to_late_listeners() -> None:
    def program(simulation: Simulation) -> None:
        asker = Asker(Node("n"))
        ActionServer(asker.node, Fibonacci, "fibonacci", succeed)
        for number in (1, 2):
            asker.send(number)
            asker.result(number)
        spin_for(asker.node, 0.1)
        states = (GoalStatus.STATUS_ACCEPTED, GoalStatus.STATUS_EXECUTING, GoalStatus.STATUS_SUCCEEDED)
        assert asker.statuses == [[*ended, state] for ended in ((), states[2:]) for state in states]

    simulate(program)


def test_a_goal_cannot_be_executed_twice() -> None:
    def program(simulation: Simulation) -> None:
        asker = Asker(Node("n"))
        begun: list[ServerGoalHandle] = []
        ActionServer(asker.node, Fibonacci, "fibonacci", succeed, handle_accepted_callback=begun.append)
        asker.send(1)
        begun[0].execute()
        with pytest.raises(RCLError, match=r"from state EXECUTING with event EXECUTE"):
            begun[0].execute()
        assert asker.result(1).status == GoalStatus.STATUS_SUCCEEDED

    simulate(program)


def test_the_callback_given_to_execute_takes_the_place_of_the_servers() -> None:
    def program(simulation: Simulation) -> None:
        asker = Asker(Node("n"))

        def abort(goal_handle: ServerGoalHandle) -> Any:
            goal_handle.abort()
            return Fibonacci.Result()

        ActionServer(
            asker.node,
            Fibonacci,
            "fibonacci",
            succeed,
            handle_accepted_callback=lambda goal_handle: goal_handle.execute(abort),
        )
        asker.send(1)
        assert asker.result(1).status == GoalStatus.STATUS_ABORTED

    simulate(program)


def test_a_destroyed_server_is_off_the_network_and_its_goals_are_over() -> None:
    def program(simulation: Simulation) -> None:
        asker = Asker(Node("n"))
        begun: list[ServerGoalHandle] = []
        server = ActionServer(
            asker.node, Fibonacci, "fibonacci", succeed, handle_accepted_callback=begun.append
        )
        asker.send(1)
        server.destroy()
        server.destroy()
        assert begun[0].status == GoalStatus.STATUS_UNKNOWN
        assert not asker.goals.service_is_ready()
        assert asker.node.count_publishers("/fibonacci/_action/status") == 0
        assert len(list(asker.node.services)) == len(list(Node("other").services))
        ActionServer(asker.node, Fibonacci, "fibonacci", succeed)
        assert asker.send(1).accepted

    simulate(program)


def test_a_server_goes_with_its_node() -> None:
    def program(simulation: Simulation) -> None:
        asker, node = Asker(Node("n")), Node("server")
        server = ActionServer(node, Fibonacci, "fibonacci", succeed)
        node.destroy_node()
        assert server.destroyed
        assert not asker.goals.service_is_ready()

    simulate(program)


def test_a_server_is_one_waitable_of_its_node() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        before = list(node.waitables)
        server = ActionServer(node, Fibonacci, "fibonacci", succeed)
        assert list(node.waitables) == [*before, server]
        server.destroy()
        assert list(node.waitables) == before

    trace = simulate(program)
    made = {event.entity for event in trace.of(EntityAppeared)}
    assert {event.entity for event in trace.of(EntityGone)} == made
    assert len(made) == 2


def test_a_server_counts_as_a_callback_that_its_program_has_to_spin_for() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        before = node.context.process.callbacks
        ActionServer(node, Fibonacci, "fibonacci", succeed)
        assert node.context.process.callbacks == before + 1

    simulate(program)


def test_a_server_counts_its_entities() -> None:
    def program(simulation: Simulation) -> None:
        counts = ActionServer(Node("n"), Fibonacci, "fibonacci", succeed).get_num_entities()
        assert (counts.num_services, counts.num_timers) == (3, 1)
        assert (counts.num_clients, counts.num_subscriptions, counts.num_guard_conditions) == (0, 0, 0)

    simulate(program)


def test_what_is_no_action_type_no_name_or_no_callback_is_refused() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        with pytest.raises(AttributeError, match="no action type"):
            ActionServer(node, Int32, "fibonacci", succeed)
        with pytest.raises(ValueError, match="fibo nacci"):
            ActionServer(node, Fibonacci, "fibo nacci", succeed)
        with pytest.raises(TypeError, match="not callable"):
            ActionServer(node, Fibonacci, "fibonacci", 3)  # type: ignore[arg-type]
        assert not any("_action" in name for name, _ in node.get_topic_names_and_types())

    simulate(program)
