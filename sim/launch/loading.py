"""Runs a launch file to get its description."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

from sim.files.untrusted import MAX_PROGRAM_BYTES, read_bytes
from sim.launch.errors import LaunchError, explained

if TYPE_CHECKING:
    from sim.launch.launch.launch_description import LaunchDescription

_GENERATE = "generate_launch_description"


def load_description(path: Path) -> LaunchDescription:
    """Run a launch file, which is a program, in this process, and return its description.

    Raises:
        LaunchError: the file cannot be read, raises an error, or returns no description.
    """
    from sim.launch.importing import install
    from sim.launch.launch.launch_description import LaunchDescription
    from sim.launch.launch.launch_description_sources import LaunchDescriptionSource

    install()
    LaunchDescriptionSource.read = load_description
    file = path.absolute()
    if file.suffix in {".xml", ".yaml", ".yml"}:
        from sim.launch.frontend import actions_in

        return LaunchDescription(actions_in(file, _source(file)))
    generate = vars(_run(file)).get(_GENERATE)
    if not callable(generate):
        raise LaunchError(f"{file.name}: it defines no function {_GENERATE}()")
    try:
        description = generate()
    except Exception as error:
        raise explained(error, file) from error
    if not isinstance(description, LaunchDescription):
        line = generate.__code__.co_firstlineno if hasattr(generate, "__code__") else 1
        raise LaunchError(
            f"{file.name}:{line}: {_GENERATE}() must return a LaunchDescription, "
            f"not {type(description).__name__}"
        )
    return description


def _source(file: Path) -> bytes:
    try:
        return read_bytes(file, MAX_PROGRAM_BYTES)
    except OSError as error:
        raise LaunchError(f"{file}: {error.strerror}") from None


def _run(file: Path) -> ModuleType:
    module = ModuleType("launch_file")
    module.__file__ = str(file)
    try:
        exec(compile(_source(file), str(file), "exec", dont_inherit=True), vars(module))
    except Exception as error:
        raise explained(error, file) from error
    return module
