"""``launch_ros.substitutions``."""

from __future__ import annotations

from typing import Any

from sim.launch.errors import unsupported
from sim.launch.launch.launch_context import LaunchContext
from sim.launch.launch.substitution import Substitution, normalize_to_list_of_substitutions, performed

__all__ = ["ExecutableInPackage", "FindPackage", "FindPackagePrefix", "FindPackageShare", "Parameter"]


class FindPackage(Substitution):
    """The base of substitutions that find a package."""

    def __init__(self, package: Any) -> None:
        self.package = normalize_to_list_of_substitutions(package)

    def describe(self) -> str:
        package = " + ".join(each.describe() for each in self.package)
        return f"{type(self).__name__}(pkg={package})"


class FindPackagePrefix(FindPackage):
    """The folder that a package is installed in."""

    def perform(self, context: LaunchContext) -> str:
        return str(context.packages.package(performed(context, self.package)).prefix)


class FindPackageShare(FindPackage):
    """The share folder of a package."""

    def perform(self, context: LaunchContext) -> str:
        return str(context.packages.package(performed(context, self.package)).share)


class ExecutableInPackage(FindPackage):
    """The path of a package's program."""

    def __init__(self, executable: Any, package: Any) -> None:
        super().__init__(package)
        self.executable = normalize_to_list_of_substitutions(executable)

    def perform(self, context: LaunchContext) -> str:
        package = context.packages.package(performed(context, self.package))
        return str(package.executable(performed(context, self.executable)).path)


Parameter = unsupported("the substitution launch_ros.substitutions.Parameter", "")
