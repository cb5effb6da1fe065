"""The two services with which other nodes read and set the levels of a program's loggers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sim.interfaces import rcl_interfaces
from sim.ros.entities.hidden_service import offer_hidden
from sim.ros.logging.logger import get_logger_level, set_logger_level
from sim.ros.qos.qos import qos_profile_services_default

if TYPE_CHECKING:
    from sim.ros.node.node import Node


class LoggingService:
    """Offers the two services, in the node's default group."""

    def __init__(self, node: Node) -> None:
        for srv_type, name, callback in (
            (rcl_interfaces.GetLoggerLevels, "get_logger_levels", _get_levels),
            (rcl_interfaces.SetLoggerLevels, "set_logger_levels", _set_levels),
        ):
            offer_hidden(node, srv_type, f"~/{name}", callback, qos_profile_services_default)


def _get_levels(request: Any, response: Any) -> Any:
    response.levels = [
        rcl_interfaces.LoggerLevel(name=name, level=int(get_logger_level(name))) for name in request.names
    ]
    return response


def _set_levels(request: Any, response: Any) -> Any:
    response.results = [_set_level(each) for each in request.levels]
    return response


def _set_level(wanted: Any) -> Any:
    try:
        set_logger_level(wanted.name, wanted.level)
    except ValueError:
        return rcl_interfaces.SetLoggerLevelsResult(
            successful=False, reason="Failed reason: Invalid logger level."
        )
    return rcl_interfaces.SetLoggerLevelsResult(successful=True)
