"""What the graph tells of actions."""

from typing import Any

import pytest

from sim.interfaces import action
from sim.ros.actions import (
    ActionClient,
    ActionServer,
    get_action_client_names_and_types_by_node,
    get_action_names_and_types,
    get_action_server_names_and_types_by_node,
)
from sim.ros.exceptions import NodeNameNonExistentError
from sim.ros.node.node import Node
from tests.support.simulation import Simulation, simulate

Fibonacci = action("example_interfaces", "Fibonacci")
TYPE = ["example_interfaces/action/Fibonacci"]


def execute(_goal_handle: Any) -> Any:
    return Fibonacci.Result()


def test_actions_are_found_by_node_and_all_together() -> None:
    def program(simulation: Simulation) -> None:
        asker = Node("asker")
        one, two = Node("one", namespace="/arm"), Node("two")
        assert get_action_names_and_types(asker) == []
        ActionServer(one, Fibonacci, "grip", execute)
        ActionServer(two, Fibonacci, "/drive", execute)
        ActionClient(two, Fibonacci, "arm/grip")
        assert get_action_server_names_and_types_by_node(asker, "one", "/arm") == [("/arm/grip", TYPE)]
        assert get_action_client_names_and_types_by_node(asker, "one", "/arm") == []
        assert get_action_server_names_and_types_by_node(asker, "two", "/") == [("/drive", TYPE)]
        assert get_action_client_names_and_types_by_node(asker, "two", "/") == [("/arm/grip", TYPE)]
        assert get_action_names_and_types(asker) == [("/arm/grip", TYPE), ("/drive", TYPE)]

    simulate(program)


def test_a_node_that_is_not_there_is_an_error() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        for ask in (get_action_client_names_and_types_by_node, get_action_server_names_and_types_by_node):
            with pytest.raises(NodeNameNonExistentError):
                ask(node, "nobody", "/")

    simulate(program)


def test_an_action_is_three_services_and_two_topics_with_hidden_names() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        ActionServer(node, Fibonacci, "count", execute)
        topics = dict(node.get_topic_names_and_types())
        services = dict(node.get_service_names_and_types())
        assert topics["/count/_action/feedback"] == [f"{TYPE[0]}_FeedbackMessage"]
        assert topics["/count/_action/status"] == ["action_msgs/msg/GoalStatusArray"]
        assert services["/count/_action/send_goal"] == [f"{TYPE[0]}_SendGoal"]
        assert services["/count/_action/cancel_goal"] == ["action_msgs/srv/CancelGoal"]
        assert services["/count/_action/get_result"] == [f"{TYPE[0]}_GetResult"]

    simulate(program)


def test_the_name_of_an_action_can_be_remapped() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n", cli_args=["--ros-args", "-r", "count:=/tally"])
        ActionServer(node, Fibonacci, "count", execute)
        assert get_action_names_and_types(node) == [("/tally", TYPE)]

    simulate(program)
