"""Nodes with a life cycle."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, cast

from sim.ros.exceptions import RCLError
from sim.ros.lifecycle import state_machine as machine
from sim.ros.lifecycle.interface import LifecycleInterface
from sim.ros.lifecycle.managed_entity import ManagedEntity
from sim.ros.lifecycle.publisher import LifecyclePublisher
from sim.ros.lifecycle.state_machine import (
    LifecycleState,
    LifecycleStateMachine,
    Transition,
    TransitionCallbackReturn,
)
from sim.ros.node.node import Node
from sim.ros.scheduling.callback_groups import CallbackGroup


class LifecycleNodeMixin(ManagedEntity):
    """Gives a node a life cycle; beside ``Node``, after whose ``__init__`` its own is called.

    The ``trigger_…`` methods and the service ``~/change_state`` lead from state to state. On the way the
    ``on_…`` methods are called, which a program overrides; those here ask the managed entities.

    Raises:
        TypeError: ``enable_communication_interface`` is neither True nor False.
    """

    def __init__(
        self, *, enable_communication_interface: bool = True, callback_group: CallbackGroup | None = None
    ) -> None:
        if not isinstance(enable_communication_interface, bool):
            raise TypeError("enable_communication_interface must be True or False")
        self._state_machine = LifecycleStateMachine()
        self._managed_entities: dict[int, ManagedEntity] = {}
        self._callbacks: dict[int, Callable[[LifecycleState], TransitionCallbackReturn]] = {
            machine.CONFIGURING: self.on_configure,
            machine.CLEANING_UP: self.on_cleanup,
            machine.SHUTTING_DOWN: self.on_shutdown,
            machine.ACTIVATING: self.on_activate,
            machine.DEACTIVATING: self.on_deactivate,
            machine.ERROR_PROCESSING: self.on_error,
        }
        self.__interface: LifecycleInterface | None = None
        if enable_communication_interface:
            self.__interface = LifecycleInterface(
                cast("Node", self), self._state_machine, self.__change_state, callback_group
            )

    # Going from state to state

    def trigger_configure(self) -> TransitionCallbackReturn:
        """Go from unconfigured to inactive; RCLError from elsewhere."""
        return self.__change_state(machine.CONFIGURE)

    def trigger_cleanup(self) -> TransitionCallbackReturn:
        """Go from inactive to unconfigured; RCLError from elsewhere."""
        return self.__change_state(machine.CLEANUP)

    def trigger_activate(self) -> TransitionCallbackReturn:
        """Go from inactive to active; RCLError from elsewhere."""
        return self.__change_state(machine.ACTIVATE)

    def trigger_deactivate(self) -> TransitionCallbackReturn:
        """Go from active to inactive; RCLError from elsewhere."""
        return self.__change_state(machine.DEACTIVATE)

    def trigger_shutdown(self) -> TransitionCallbackReturn:
        """Go to finalized; RCLError from there."""
        state, _ = self._state_machine.current_state
        if state not in machine.SHUTDOWN_FROM:
            raise RCLError("Shutdown transition not possible")
        return self.__change_state(machine.SHUTDOWN_FROM[state])

    def __change_state(self, transition_id: int) -> TransitionCallbackReturn:
        state_id, label = self._state_machine.current_state
        before = LifecycleState(label=label, state_id=state_id)
        try:
            self.__tell(self._state_machine.trigger_transition_by_id(transition_id))
        except RCLError:
            node = cast("Node", self)
            if not node.context.host.profile.refuses_transitions:
                raise
            at = (state_id, label)
            node.get_logger().error(f"Unable to start transition {transition_id} from current state {at}")
            return TransitionCallbackReturn.ERROR
        outcome = self.__outcome(before)
        self.__tell(self._state_machine.trigger_transition_by_label(outcome.to_label()))
        if outcome is TransitionCallbackReturn.ERROR:
            mended = self.__outcome(before)
            self.__tell(self._state_machine.trigger_transition_by_label(mended.to_label()))
        return outcome

    def __outcome(self, before: LifecycleState) -> TransitionCallbackReturn:
        state_id, label = self._state_machine.current_state
        try:
            return self._callbacks[state_id](before)
        except Exception as error:  # noqa: BLE001 -- as in rclpy, the state machine deals with it
            cast("Node", self).get_logger().error(f"the callback for the state '{label}' raised {error!r}")
            return TransitionCallbackReturn.ERROR

    def __tell(self, transition: Transition) -> None:
        if self.__interface is not None:
            self.__interface.tell(transition)

    # What takes part

    def add_managed_entity(self, entity: ManagedEntity) -> None:
        """Have an entity take part in the life cycle."""
        self._managed_entities[id(entity)] = entity

    def create_lifecycle_publisher(self, *args: Any, **kwargs: Any) -> LifecyclePublisher:
        """Make a publisher that sends only while the node is active; otherwise as ``create_publisher``."""
        if "publisher_class" in kwargs:
            raise TypeError("create_publisher() got an unexpected keyword argument 'publisher_class'")
        publisher = cast("Node", self).create_publisher(*args, **kwargs, publisher_class=LifecyclePublisher)
        assert isinstance(publisher, LifecyclePublisher)
        self.add_managed_entity(publisher)
        return publisher

    def destroy_lifecycle_publisher(self, publisher: LifecyclePublisher) -> bool:
        """Remove a publisher; whether it was this node's."""
        self._managed_entities.pop(id(publisher), None)
        return cast("Node", self).destroy_publisher(publisher)

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Have the managed entities configured."""
        return self.__ask_entities("on_configure", state)

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Have the managed entities cleaned up."""
        return self.__ask_entities("on_cleanup", state)

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Have the managed entities shut down."""
        return self.__ask_entities("on_shutdown", state)

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Have the managed entities activated."""
        return self.__ask_entities("on_activate", state)

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Have the managed entities deactivated."""
        return self.__ask_entities("on_deactivate", state)

    def on_error(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Have the managed entities deal with an error."""
        return self.__ask_entities("on_error", state)

    def __ask_entities(self, callback_name: str, state: LifecycleState) -> TransitionCallbackReturn:
        for entity in tuple(self._managed_entities.values()):
            outcome = getattr(entity, callback_name)(state)
            if not isinstance(outcome, TransitionCallbackReturn):
                raise TypeError(f"{callback_name}() should return a TransitionCallbackReturn")
            if outcome is not TransitionCallbackReturn.SUCCESS:
                return outcome
        return TransitionCallbackReturn.SUCCESS


class LifecycleNode(LifecycleNodeMixin, Node):
    """A node with a life cycle; without ``enable_communication_interface`` others cannot steer it.

    All else is as for ``Node``.
    """

    def __init__(self, node_name: str, *, enable_communication_interface: bool = True, **kwargs: Any) -> None:
        Node.__init__(self, node_name, **kwargs)
        LifecycleNodeMixin.__init__(self, enable_communication_interface=enable_communication_interface)
