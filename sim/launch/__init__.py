"""Launch files: ``launch`` and ``launch_ros`` as a launch file sees them, and what carries one out."""

from sim.launch.arguments import describe_arguments
from sim.launch.errors import LaunchError
from sim.launch.machine import Machine, OnOutput, ProcessSpec, RunningProcess
from sim.launch.run import LaunchRun

__all__ = [
    "LaunchError",
    "LaunchRun",
    "Machine",
    "OnOutput",
    "ProcessSpec",
    "RunningProcess",
    "describe_arguments",
]
