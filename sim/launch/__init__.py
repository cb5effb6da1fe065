"""Launch files: ``launch`` and ``launch_ros`` as a launch file sees them, and what carries one out."""

from sim.launch.arguments import LaunchArgument, describe_arguments, launch_arguments
from sim.launch.errors import LaunchError
from sim.launch.machine import Machine, ProcessSpec, RunningProcess
from sim.launch.run import LaunchRun

__all__ = [
    "LaunchArgument",
    "LaunchError",
    "LaunchRun",
    "Machine",
    "ProcessSpec",
    "RunningProcess",
    "describe_arguments",
    "launch_arguments",
]
