"""The messages and services of the package rcl_interfaces, each built when it is first used."""

from typing import Any

from sim.interfaces import message, names, service


def __getattr__(name: str) -> Any:
    if name.startswith("_"):
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    build = service if name in names("rcl_interfaces", "srv") else message
    made = build("rcl_interfaces", name)
    globals()[name] = made
    return made
