"""``launch.launch_description_sources``: where an included launch description comes from."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, ClassVar

from sim.launch.errors import LaunchError, LaunchFailure
from sim.launch.launch.launch_context import LaunchContext
from sim.launch.launch.launch_description import LaunchDescription
from sim.launch.launch.substitution import TextSubstitution, normalize_to_list_of_substitutions, performed

__all__ = [
    "AnyLaunchDescriptionSource",
    "FrontendLaunchDescriptionSource",
    "LaunchDescriptionSource",
    "PythonLaunchDescriptionSource",
]


class LaunchDescriptionSource:
    """A launch file at a path that may be a substitution."""

    read: ClassVar[Callable[[Path], LaunchDescription]]
    """Reads a launch file of any kind; set by the loader, since a file may include others."""

    def __init__(self, launch_file_path: Any) -> None:
        self._location = normalize_to_list_of_substitutions(launch_file_path)

    def load(self, context: LaunchContext) -> tuple[LaunchDescription, Path]:
        """Return the description and its file.

        Raises:
            LaunchFailure: the file does not exist.
            LaunchError: the file cannot be read.
        """
        path = Path(performed(context, self._location))
        if not path.is_file():
            raise LaunchFailure(f"the included launch file {path} does not exist")
        return type(self).read(path), path.absolute()

    def known_description(self) -> LaunchDescription | None:
        """Return the description if its path is known before the launch and readable; else None."""
        if not all(isinstance(each, TextSubstitution) for each in self._location):
            return None
        path = Path("".join(each.text for each in self._location if isinstance(each, TextSubstitution)))
        try:
            return type(self).read(path) if path.is_file() else None
        except LaunchError:
            return None


class PythonLaunchDescriptionSource(LaunchDescriptionSource):
    """A launch file in Python."""


class AnyLaunchDescriptionSource(LaunchDescriptionSource):
    """A launch file of any kind: in Python, XML or YAML."""


class FrontendLaunchDescriptionSource(LaunchDescriptionSource):
    """A launch file in XML or YAML."""
