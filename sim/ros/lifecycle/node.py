"""Lifecycle nodes."""

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
    """Adds a life cycle to a node; its ``__init__`` must be called after ``Node.__init__``.

    The ``trigger_…`` methods and the service ``~/change_state`` make transitions, which call the
    ``on_…`` methods. A program overrides these; the methods here call those of the managed entities.

    Raises:
        TypeError: ``enable_communication_interface`` is not a bool.
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

    # Transitions

    def trigger_configure(self) -> TransitionCallbackReturn:
        """Change from unconfigured to inactive; RCLError in another state."""
        return self.__change_state(machine.CONFIGURE)

    def trigger_cleanup(self) -> TransitionCallbackReturn:
        """Change from inactive to unconfigured; RCLError in another state."""
        return self.__change_state(machine.CLEANUP)

    def trigger_activate(self) -> TransitionCallbackReturn:
        """Change from inactive to active; RCLError in another state."""
        return self.__change_state(machine.ACTIVATE)

    def trigger_deactivate(self) -> TransitionCallbackReturn:
        """Change from active to inactive; RCLError in another state."""
        return self.__change_state(machine.DEACTIVATE)

    def trigger_shutdown(self) -> TransitionCallbackReturn:
        """Change to finalized; RCLError if the node is finalized."""
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
            self.__interface.publish_transition(transition)

    # Managed entities

    def add_managed_entity(self, entity: ManagedEntity) -> None:
        """Add an entity to the life cycle."""
        self._managed_entities[id(entity)] = entity

    def create_lifecycle_publisher(self, *args: Any, **kwargs: Any) -> LifecyclePublisher:
        """Create a publisher that sends only while the node is active; otherwise as ``create_publisher``."""
        if "publisher_class" in kwargs:
            raise TypeError("create_publisher() got an unexpected keyword argument 'publisher_class'")
        publisher = cast("Node", self).create_publisher(*args, **kwargs, publisher_class=LifecyclePublisher)
        assert isinstance(publisher, LifecyclePublisher)
        self.add_managed_entity(publisher)
        return publisher

    def destroy_lifecycle_publisher(self, publisher: LifecyclePublisher) -> bool:
        """Remove a publisher; False if it is not this node's."""
        self._managed_entities.pop(id(publisher), None)
        return cast("Node", self).destroy_publisher(publisher)

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Configure the managed entities."""
        return self.__ask_entities("on_configure", state)

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Clean up the managed entities."""
        return self.__ask_entities("on_cleanup", state)

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Shut down the managed entities."""
        return self.__ask_entities("on_shutdown", state)

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Activate the managed entities."""
        return self.__ask_entities("on_activate", state)

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Deactivate the managed entities."""
        return self.__ask_entities("on_deactivate", state)

    def on_error(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Let the managed entities handle an error."""
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
    """A lifecycle node. Without ``enable_communication_interface`` other nodes cannot control it.

    The other arguments are those of ``Node``.
    """

    def __init__(self, node_name: str, *, enable_communication_interface: bool = True, **kwargs: Any) -> None:
        Node.__init__(self, node_name, **kwargs)
        LifecycleNodeMixin.__init__(self, enable_communication_interface=enable_communication_interface)
