"""Launch files: ``launch`` and ``launch_ros`` as a launch file imports them, and their execution."""

from sim.launch.arguments import describe_arguments
from sim.launch.errors import LaunchError
from sim.launch.machine import OnOutput, ProcessSpec, RunningProcess
from sim.launch.run import LaunchRun

__all__ = [
    "LaunchError",
    "LaunchRun",
    "OnOutput",
    "ProcessSpec",
    "RunningProcess",
    "describe_arguments",
]
