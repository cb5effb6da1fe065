"""``launch_ros.actions.Node``: starts a program of a package as a node."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from sim.launch.errors import LaunchFailure
from sim.launch.launch.actions.process import ExecuteLocal
from sim.launch.launch.launch_context import LaunchContext
from sim.launch.launch.substitution import normalize_to_list_of_substitutions, performed
from sim.launch.launch_ros.namespaces import joined
from sim.launch.launch_ros.parameters import parameter_arguments
from sim.launch.machine import ProcessSpec
from sim.packages import Executable


class Node(ExecuteLocal):
    """Starts an executable of a package with a node's name, namespace, parameters and remappings.

    Without ``package``, ``executable`` is the path of a Python file.
    """

    def __init__(
        self,
        *,
        executable: Any,
        package: Any = None,
        name: Any = None,
        namespace: Any = None,
        parameters: Iterable[Any] | None = None,
        remappings: Iterable[tuple[Any, Any]] | None = None,
        ros_arguments: Iterable[Any] | None = None,
        arguments: Iterable[Any] | None = None,
        exec_name: Any = None,
        **kwargs: Any,
    ) -> None:
        super().__init__(exec_name=exec_name, **kwargs)
        if parameters is not None and isinstance(parameters, (str, dict)):
            raise TypeError("Node's parameters are wanted as a list, such as [{'speed': 0.2}]")
        self._package = None if package is None else normalize_to_list_of_substitutions(package)
        self._executable = normalize_to_list_of_substitutions(executable)
        self._node_name = None if name is None else normalize_to_list_of_substitutions(name)
        self._namespace = None if namespace is None else normalize_to_list_of_substitutions(namespace)
        self._parameters = list(parameters or ())
        self._remappings = list(remappings or ())
        self._ros_arguments = list(ros_arguments or ())
        self._arguments = [arguments] if isinstance(arguments, str) else list(arguments or ())

    def prepare(self, context: LaunchContext) -> ProcessSpec:
        program = self._program(context)
        return ProcessSpec(
            arguments=tuple(self._all_arguments(context)),
            label=self.label(context, program.name),
            path=program.path,
            folder=program.folder,
            module=program.module,
            function=program.function,
            package="" if self._package is None else performed(context, self._package),
            executable=program.name,
            environment=self.environment(context),
            output=self.output(context),
            working_folder=self.working_folder(context),
        )

    def _program(self, context: LaunchContext) -> Executable:
        name = performed(context, self._executable)
        if self._package is not None:
            return context.packages.package(performed(context, self._package)).executable(name)
        path = Path(name)
        if not path.is_file():
            raise LaunchFailure(
                f"a Node without a package has a file as its executable, but {path} does not exist"
            )
        return Executable(path.name, path.absolute(), path.resolve().parent)

    def _all_arguments(self, context: LaunchContext) -> list[str]:
        found = [performed(context, each) for each in self._arguments]
        found.append("--ros-args")
        found += (performed(context, each) for each in self._ros_arguments)
        if self._node_name is not None:
            found += ["-r", f"__node:={performed(context, self._node_name)}"]
        own = "" if self._namespace is None else performed(context, self._namespace)
        namespace = joined(context.namespace, own)
        if namespace:
            found += ["-r", f"__ns:={namespace if namespace.startswith('/') else f'/{namespace}'}"]
        for each in context.global_parameters:
            found += each
        found += parameter_arguments(context, self._parameters)
        own_remaps = [(performed(context, a), performed(context, b)) for a, b in self._remappings]
        for before, after in (*context.global_remaps, *own_remaps):
            found += ["-r", f"{before}:={after}"]
        return found
