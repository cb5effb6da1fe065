"""The services and the topic with which other nodes observe and control a node's life cycle."""

from collections.abc import Callable, Iterable
from typing import Any

from sim.interfaces import message, service
from sim.ros.entities.hidden_service import offer_hidden
from sim.ros.exceptions import RCLError
from sim.ros.lifecycle.state_machine import (
    STATES,
    LifecycleStateMachine,
    Transition,
    TransitionCallbackReturn,
)
from sim.ros.node.node import Node
from sim.ros.qos.qos import QoSProfile
from sim.ros.scheduling.callback_groups import CallbackGroup

_PACKAGE = "lifecycle_msgs"
_QOS = QoSProfile(depth=10)


class LifecycleInterface:
    """Offers ``~/change_state``, four services that return states, and the topic ``~/transition_event``.

    The trace shows ``~/change_state``, because it runs the program's callbacks, but not the other four.
    """

    def __init__(
        self,
        node: Node,
        machine: LifecycleStateMachine,
        change_state: Callable[[int], TransitionCallbackReturn],
        callback_group: CallbackGroup | None,
    ) -> None:
        self._node = node
        self._machine = machine
        self._change = change_state
        self._events = node.create_publisher(message(_PACKAGE, "TransitionEvent"), "~/transition_event", _QOS)
        node.create_service(
            service(_PACKAGE, "ChangeState"),
            "~/change_state",
            self.change_state,
            qos_profile=_QOS,
            callback_group=callback_group,
        )
        for kind, name, callback in (
            ("GetState", "get_state", self._get_state),
            ("GetAvailableStates", "get_available_states", self._get_available_states),
            ("GetAvailableTransitions", "get_available_transitions", self._get_available_transitions),
            ("GetAvailableTransitions", "get_transition_graph", self._get_transition_graph),
        ):
            offer_hidden(node, service(_PACKAGE, kind), f"~/{name}", callback, _QOS, callback_group)

    def publish_transition(self, transition: Transition) -> None:
        """Publish the states of a transition; without a subscription nothing is sent.

        As in rcl, the event's other fields stay empty.
        """
        if self._events.get_subscription_count() == 0:
            return
        event = message(_PACKAGE, "TransitionEvent")(
            start_state=_state(transition.start),
            goal_state=_state(transition.goal),
        )
        self._events.publish(event)

    def change_state(self, request: Any, response: Any) -> Any:
        """Make the requested transition, by its label or else by its id, if the node's state allows it."""
        wanted = request.transition
        number = wanted.id
        if wanted.label:
            try:
                number = self._machine.get_transition_by_label(wanted.label)
            except RCLError:
                response.success = False
                return response
        response.success = self._change(number) is TransitionCallbackReturn.SUCCESS
        return response

    def _get_state(self, _request: Any, response: Any) -> Any:
        response.current_state = _state(self._machine.current_state[0])
        return response

    def _get_available_states(self, _request: Any, response: Any) -> Any:
        response.available_states = [_state(number) for number, _ in self._machine.available_states]
        return response

    def _get_available_transitions(self, _request: Any, response: Any) -> Any:
        response.available_transitions = _described(self._machine.available_transitions)
        return response

    def _get_transition_graph(self, _request: Any, response: Any) -> Any:
        response.available_transitions = _described(self._machine.transition_graph)
        return response


def _described(transitions: Iterable[Transition]) -> list[Any]:
    description = message(_PACKAGE, "TransitionDescription")
    return [
        description(
            transition=_transition(each), start_state=_state(each.start), goal_state=_state(each.goal)
        )
        for each in transitions
    ]


def _transition(transition: Transition) -> Any:
    return message(_PACKAGE, "Transition")(id=transition.transition_id, label=transition.label)


def _state(number: int) -> Any:
    return message(_PACKAGE, "State")(id=number, label=STATES[number])
