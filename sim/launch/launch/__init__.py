"""The launch model: what ``import launch`` gives a launch file. Module names mirror launch's."""

from sim.launch.errors import unsupported
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

LaunchService = unsupported("LaunchService", ": start the launch file with 'ros2 launch'")
