"""Runs a launch file to get its description."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

from sim.foreign_file import MOST_OF_A_PROGRAM, read_bytes
from sim.launch.errors import LaunchError, explained

if TYPE_CHECKING:
    from sim.launch.launch.launch_description import LaunchDescription

_GENERATE = "generate_launch_description"


def load_description(path: Path) -> LaunchDescription:
    """Run the launch file in this process and return what it describes.

    The file is a program: it may do anything.

    Raises:
        LaunchError: it cannot be read, raises, or describes no launch.
    """
    from sim.launch.importing import install
    from sim.launch.launch.launch_description import LaunchDescription

    install()
    file = path.absolute()
    if file.suffix != ".py":
        raise LaunchError(f"{file.name}: launch files in XML and YAML are not supported; write it in Python")
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


def _run(file: Path) -> ModuleType:
    try:
        source = read_bytes(file, MOST_OF_A_PROGRAM)
    except OSError as error:
        raise LaunchError(f"{file}: {error.strerror}") from None
    module = ModuleType("launch_file")
    module.__file__ = str(file)
    try:
        exec(compile(source, str(file), "exec", dont_inherit=True), vars(module))
    except Exception as error:
        raise explained(error, file) from error
    return module
