"""Actions with settings for all later nodes in their group."""

from __future__ import annotations

from typing import Any

from sim.launch.launch.action import Action
from sim.launch.launch.launch_context import LaunchContext
from sim.launch.launch.substitution import normalize_to_list_of_substitutions, performed
from sim.launch.launch_ros.namespaces import joined
from sim.launch.launch_ros.parameters import file_arguments, parameter_arguments


class PushROSNamespace(Action):
    """Puts the nodes into a namespace inside the current one."""

    def __init__(self, namespace: Any, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._namespace = normalize_to_list_of_substitutions(namespace)

    def execute(self, context: LaunchContext) -> None:
        context.namespace = joined(context.namespace, performed(context, self._namespace))


class SetRemap(Action):
    """Gives the nodes a remapping."""

    def __init__(self, src: Any, dst: Any, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._src = normalize_to_list_of_substitutions(src)
        self._dst = normalize_to_list_of_substitutions(dst)

    def execute(self, context: LaunchContext) -> None:
        context.global_remaps.append((performed(context, self._src), performed(context, self._dst)))


class SetParameter(Action):
    """Gives the nodes a parameter; their own parameters take precedence."""

    def __init__(self, name: Any, value: Any, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._name = name
        self._value = value

    def execute(self, context: LaunchContext) -> None:
        name = performed(context, self._name)
        context.global_parameters.append(parameter_arguments(context, [{name: self._value}]))


class SetUseSimTime(SetParameter):
    """Sets whether the nodes take the time from the clock topic."""

    def __init__(self, value: Any, **kwargs: Any) -> None:
        super().__init__("use_sim_time", value, **kwargs)


class SetParametersFromFile(Action):
    """Gives the nodes the parameters of a file; their own parameters take precedence."""

    def __init__(self, filename: Any, *, node_name: Any = None, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        if node_name is not None:
            raise NotImplementedError("SetParametersFromFile(node_name=…) is not supported")
        self._file = normalize_to_list_of_substitutions(filename)

    def execute(self, context: LaunchContext) -> None:
        context.global_parameters.append(file_arguments(context, self._file))
