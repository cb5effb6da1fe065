"""``launch_ros.descriptions``."""

from sim.launch.launch_ros.parameter_descriptions import Parameter, ParameterFile, ParameterValue

__all__ = ["ComposableNode", "Parameter", "ParameterFile", "ParameterValue"]


class ComposableNode:
    """Not supported: nodes written in C++ cannot be loaded."""

    def __init__(self, *_: object, **__: object) -> None:
        raise NotImplementedError("ComposableNode is not supported: components are compiled from C++")
