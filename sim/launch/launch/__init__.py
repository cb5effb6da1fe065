"""The launch model: what ``import launch`` gives a launch file. Module names mirror launch's."""

from sim.launch.launch.action import Action, LaunchDescriptionEntity
from sim.launch.launch.condition import Condition
from sim.launch.launch.event import Event
from sim.launch.launch.event_handler import EventHandler
from sim.launch.launch.launch_context import LaunchContext
from sim.launch.launch.launch_description import LaunchDescription
from sim.launch.launch.launch_description_sources import LaunchDescriptionSource
from sim.launch.launch.substitution import SomeSubstitutionsType, Substitution

__all__ = [
    "Action",
    "Condition",
    "Event",
    "EventHandler",
    "LaunchContext",
    "LaunchDescription",
    "LaunchDescriptionEntity",
    "LaunchDescriptionSource",
    "LaunchService",
    "SomeSubstitutionsType",
    "Substitution",
]


class LaunchService:
    """Not supported: a launch file is started from outside."""

    def __init__(self, *_: object, **__: object) -> None:
        raise NotImplementedError("LaunchService is not supported: start the launch file with 'ros2 launch'")
