"""Builds the classes of services and actions, which contain the classes of their parts."""

from collections.abc import Callable

from sim.interfaces.action_parts import ActionDefinition
from sim.interfaces.base import ActionImpl, ActionType, Message, ServiceType
from sim.interfaces.interface_definition import Definition

Build = Callable[[Definition], type[Message]]
"""Returns the class of one structure."""


def service_class(request: Definition, response: Definition, build: Build) -> ServiceType:
    """Return a new class for a service."""
    name = request.name.removesuffix("_Request")
    type_name = f"{request.package}/{request.kind}/{name}"
    return ServiceType(
        name,
        (),
        {
            "__module__": request.module_name,
            "__doc__": f"Service class for {type_name}; it is not instantiated.",
            "__type_name__": type_name,
            "Request": build(request),
            "Response": build(response),
        },
    )


def action_class(
    parts: ActionDefinition, build: Build, cancel_goal: ServiceType, goal_status: type[Message]
) -> ActionType:
    """Return a new class for an action; all actions share the last two arguments."""
    package, module = parts.goal.package, parts.goal.module_name
    name = parts.goal.name.removesuffix("_Goal")
    own = {"Goal": build(parts.goal), "Result": build(parts.result), "Feedback": build(parts.feedback)}
    carriers = {
        "SendGoalService": service_class(*parts.send_goal, build),
        "GetResultService": service_class(*parts.get_result, build),
        "FeedbackMessage": build(parts.feedback_message),
        "CancelGoalService": cancel_goal,
        "GoalStatusMessage": goal_status,
    }
    impl = {"__module__": module, "__qualname__": f"{name}.Impl", **carriers}
    return ActionType(
        name,
        (),
        {
            "__module__": module,
            "__doc__": f"Action class for {package}/action/{name}; it is not instantiated.",
            "__type_name__": f"{package}/action/{name}",
            **own,
            "Impl": type("Impl", (ActionImpl,), impl),
        },
    )
