"""Lists interfaces; mirrors ``rosidl_runtime_py.get_interfaces``."""

from collections.abc import Iterable
from typing import NoReturn, get_args

from sim.interfaces.interface_definition import Kind
from sim.interfaces.known import names, packages


def get_all_interface_packages() -> set[str]:
    """Return the names of all interface packages."""
    return set(packages())


def get_interface_packages() -> dict[str, list[str]]:
    """Return every package with its interfaces: ``{"std_srvs": ["srv/Empty", …], …}``."""
    return get_interfaces()


def get_interfaces(package_names: Iterable[str] = ()) -> dict[str, list[str]]:
    """Return the interfaces of the given packages, or of all: ``{"std_srvs": ["srv/Empty", …]}``.

    Raises:
        LookupError: there is no such package.
    """
    return {
        package: sorted(f"{kind}/{name}" for kind in get_args(Kind) for name in names(package, kind))
        for package in _chosen(package_names)
    }


def get_message_interfaces(package_names: Iterable[str] = ()) -> dict[str, list[str]]:
    """Return the messages of the given packages, or of all: ``{"std_msgs": ["Bool", …]}``."""
    return _of_kind("msg", package_names)


def get_service_interfaces(package_names: Iterable[str] = ()) -> dict[str, list[str]]:
    """Return the services of the given packages, or of all."""
    return _of_kind("srv", package_names)


def get_action_interfaces(package_names: Iterable[str] = ()) -> dict[str, list[str]]:
    """Return the actions of the given packages, or of all."""
    return _of_kind("action", package_names)


def get_interface_path(interface_name: str) -> NoReturn:
    """Raise `NotImplementedError`: the standard interfaces have no files of their own."""
    raise NotImplementedError("rosidl_runtime_py.get_interface_path is not supported")


def _of_kind(kind: Kind, package_names: Iterable[str]) -> dict[str, list[str]]:
    found = {package: list(names(package, kind)) for package in _chosen(package_names)}
    return {package: interfaces for package, interfaces in found.items() if interfaces}


def _chosen(package_names: Iterable[str]) -> list[str]:
    return list(package_names) or sorted(packages())
