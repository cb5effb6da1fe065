"""The parameter ``use_sim_time``, which every node has."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sim.ros import rcl_interfaces
from sim.ros.parameter import Parameter

if TYPE_CHECKING:
    from sim.ros.node import Node

USE_SIM_TIME_NAME = "use_sim_time"


class TimeSource:
    """Declares ``use_sim_time`` on a node, and refuses it any value that is no truth value."""

    def __init__(self, *, node: Node) -> None:
        self._logger = node.get_logger()
        if not node.has_parameter(USE_SIM_TIME_NAME):
            node.declare_parameter(USE_SIM_TIME_NAME, False)
        parameter = node.get_parameter(USE_SIM_TIME_NAME)
        self.ros_time_is_active = parameter.value is True
        if parameter.type_ is not Parameter.Type.BOOL:
            self._logger.error(
                f"Invalid type for parameter '{USE_SIM_TIME_NAME}' {parameter.type_!r} should be bool"
            )
        node.add_on_set_parameters_callback(self._on_set)

    def _on_set(self, parameters: list[Parameter[Any]]) -> Any:
        for parameter in parameters:
            if parameter.name != USE_SIM_TIME_NAME:
                continue
            if parameter.type_ is not Parameter.Type.BOOL:
                reason = f"{USE_SIM_TIME_NAME} parameter set to something besides a bool"
                self._logger.error(reason)
                return rcl_interfaces.SetParametersResult(successful=False, reason=reason)
            self.ros_time_is_active = parameter.value
        return rcl_interfaces.SetParametersResult(successful=True)
