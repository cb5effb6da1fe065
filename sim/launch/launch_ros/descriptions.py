"""``launch_ros.descriptions``."""

from sim.launch.errors import COMPILED, unsupported
from sim.launch.launch_ros.parameter_descriptions import Parameter, ParameterFile, ParameterValue

__all__ = ["ComposableNode", "Parameter", "ParameterFile", "ParameterValue"]

ComposableNode = unsupported("ComposableNode", COMPILED)
