"""The states and transitions of a lifecycle node, independent of the node itself.

Source: the ROS 2 design article "Managed nodes"; numbers and labels are those of lifecycle_msgs and rcl.
"""

from enum import Enum
from typing import NamedTuple

from sim.ros.exceptions import RCLError


class LifecycleState(NamedTuple):
    """A state, as callbacks get the state that their node leaves."""

    label: str
    state_id: int


class TransitionCallbackReturn(Enum):
    """The outcome of a transition's callback."""

    SUCCESS = 97
    FAILURE = 98
    ERROR = 99

    def to_label(self) -> str:
        """The label of the transition that follows."""
        return f"transition_{self.name.lower()}"


class Transition(NamedTuple):
    """A transition between two states, which are given by their ids."""

    transition_id: int
    label: str
    start: int
    goal: int


UNCONFIGURED, INACTIVE, ACTIVE, FINALIZED = 1, 2, 3, 4
CONFIGURING, CLEANING_UP, SHUTTING_DOWN, ACTIVATING, DEACTIVATING, ERROR_PROCESSING = range(10, 16)

STATES = {
    0: "unknown",
    UNCONFIGURED: "unconfigured",
    INACTIVE: "inactive",
    ACTIVE: "active",
    FINALIZED: "finalized",
    CONFIGURING: "configuring",
    CLEANING_UP: "cleaningup",
    SHUTTING_DOWN: "shuttingdown",
    ACTIVATING: "activating",
    DEACTIVATING: "deactivating",
    ERROR_PROCESSING: "errorprocessing",
}
CONFIGURE, CLEANUP, ACTIVATE, DEACTIVATE = 1, 2, 3, 4
SHUTDOWN_FROM = {UNCONFIGURED: 5, INACTIVE: 6, ACTIVE: 7}
"""The id of the shutdown transition by its start state."""


def _outcomes(first: int, state: int, success: int, failure: int, error: int) -> tuple[Transition, ...]:
    return (
        Transition(first, "transition_success", state, success),
        Transition(first + 1, "transition_failure", state, failure),
        Transition(first + 2, "transition_error", state, error),
    )


TRANSITIONS = (
    Transition(CONFIGURE, "configure", UNCONFIGURED, CONFIGURING),
    *_outcomes(10, CONFIGURING, INACTIVE, UNCONFIGURED, ERROR_PROCESSING),
    Transition(CLEANUP, "cleanup", INACTIVE, CLEANING_UP),
    *_outcomes(20, CLEANING_UP, UNCONFIGURED, INACTIVE, ERROR_PROCESSING),
    Transition(ACTIVATE, "activate", INACTIVE, ACTIVATING),
    *_outcomes(30, ACTIVATING, ACTIVE, INACTIVE, ERROR_PROCESSING),
    Transition(DEACTIVATE, "deactivate", ACTIVE, DEACTIVATING),
    *_outcomes(40, DEACTIVATING, INACTIVE, ACTIVE, ERROR_PROCESSING),
    *(Transition(number, "shutdown", state, SHUTTING_DOWN) for state, number in SHUTDOWN_FROM.items()),
    *_outcomes(50, SHUTTING_DOWN, FINALIZED, FINALIZED, ERROR_PROCESSING),
    *_outcomes(60, ERROR_PROCESSING, UNCONFIGURED, FINALIZED, FINALIZED),
)


class LifecycleStateMachine:
    """The state of one node. Not thread-safe."""

    def __init__(self) -> None:
        self._state = UNCONFIGURED

    @property
    def initialized(self) -> bool:
        """True: the state machine is always initialised."""
        return True

    @property
    def current_state(self) -> tuple[int, str]:
        """Id and label of the state."""
        return self._state, STATES[self._state]

    @property
    def available_states(self) -> list[tuple[int, str]]:
        """Ids and labels of all states."""
        return list(STATES.items())

    @property
    def available_transitions(self) -> list[Transition]:
        """The transitions from the present state."""
        return [each for each in TRANSITIONS if each.start == self._state]

    @property
    def transition_graph(self) -> list[Transition]:
        """All transitions."""
        return list(TRANSITIONS)

    def get_transition_by_label(self, label: str) -> int:
        """The id of the present state's transition with a label; RCLError without such a transition."""
        return self._transition(label).transition_id

    def trigger_transition_by_id(self, transition_id: int) -> Transition:
        """Make the transition with an id; RCLError if the state has no such transition."""
        return self._take(self._transition(transition_id))

    def trigger_transition_by_label(self, label: str) -> Transition:
        """Make the transition with a label; RCLError if the state has no such transition."""
        return self._take(self._transition(label))

    def _transition(self, wanted: int | str) -> Transition:
        for each in self.available_transitions:
            if wanted in (each.transition_id, each.label):
                return each
        raise RCLError(
            "Failed to trigger lifecycle state machine transition: Transition is not registered: "
            f"no transition matching {wanted} found for current state {STATES[self._state]}"
        )

    def _take(self, transition: Transition) -> Transition:
        self._state = transition.goal
        return transition
