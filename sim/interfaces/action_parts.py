"""The structures that rosidl makes from an action's goal, result and feedback."""

from typing import Final

from attrs import frozen
from rosbags.interfaces import Nodetype
from rosbags.interfaces.typing import Fielddefs, FieldDesc

from sim.interfaces.interface_definition import Definition

_GOAL_ID: Final[tuple[str, FieldDesc]] = ("goal_id", (Nodetype.NAME, "unique_identifier_msgs/msg/UUID"))
_STAMP: Final[tuple[str, FieldDesc]] = ("stamp", (Nodetype.NAME, "builtin_interfaces/msg/Time"))


@frozen
class ActionDefinition:
    """The three structures of an ``.action`` file, and the structures that carry them between programs.

    Source: "Actions" in ROS 2's design documents, and ``rosidl_parser.definition.Action``.
    """

    goal: Definition
    result: Definition
    feedback: Definition

    @property
    def send_goal(self) -> tuple[Definition, Definition]:
        """Request and response of the service that asks for a goal."""
        request: Fielddefs = [_GOAL_ID, ("goal", self._named(self.goal))]
        response: Fielddefs = [("accepted", (Nodetype.BASE, ("bool", 0))), _STAMP]
        return self._structure("SendGoal_Request", request), self._structure("SendGoal_Response", response)

    @property
    def get_result(self) -> tuple[Definition, Definition]:
        """Request and response of the service that waits for the result."""
        response: Fielddefs = [("status", (Nodetype.BASE, ("int8", 0))), ("result", self._named(self.result))]
        return self._structure("GetResult_Request", [_GOAL_ID]), self._structure(
            "GetResult_Response", response
        )

    @property
    def feedback_message(self) -> Definition:
        """The message that carries feedback."""
        return self._structure("FeedbackMessage", [_GOAL_ID, ("feedback", self._named(self.feedback))])

    def _structure(self, suffix: str, fields: Fielddefs) -> Definition:
        name = f"{self.goal.name.removesuffix('Goal')}{suffix}"
        return Definition(self.goal.package, "action", name, [], fields)

    def _named(self, part: Definition) -> FieldDesc:
        return (Nodetype.NAME, part.type_name)
