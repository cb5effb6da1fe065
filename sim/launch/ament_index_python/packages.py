"""``ament_index_python.packages``: the folders of packages."""

from __future__ import annotations

import re
from pathlib import Path

from sim.launch.errors import LaunchFailure
from sim.packages import Package, UnknownPackageError, known_packages

__all__ = [
    "PackageNotFoundError",
    "get_package_prefix",
    "get_package_share_directory",
    "get_package_share_path",
    "get_packages_with_prefixes",
]


class PackageNotFoundError(LaunchFailure, KeyError):
    """There is no package of that name."""

    def __str__(self) -> str:
        return str(self.args[0])


def _package(name: str) -> Package:
    try:
        return known_packages().package(name)
    except UnknownPackageError as error:
        raise PackageNotFoundError(str(error)) from None


def get_package_prefix(package_name: str) -> str:
    """Return the folder that a package is installed in.

    Raises:
        PackageNotFoundError: there is no such package.
        ValueError: the name is not valid for a package.
    """
    if re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_-]+", package_name) is None:
        raise ValueError(f"'{package_name}' is not a valid package name")
    return str(_package(package_name).prefix)


def get_package_share_directory(package_name: str) -> str:
    """Return the share folder of a package. Raises as `get_package_prefix`."""
    return str(get_package_share_path(package_name))


def get_package_share_path(package_name: str) -> Path:
    """Return the share folder of a package, as a path. Raises as `get_package_prefix`."""
    get_package_prefix(package_name)
    return _package(package_name).share


def get_packages_with_prefixes() -> dict[str, str]:
    """Return the install folder of each known package, by name."""
    return {package.name: str(package.prefix) for package in known_packages()}
