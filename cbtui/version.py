"""The version of cbtui."""

from importlib.metadata import PackageNotFoundError, version


def own_version() -> str:
    """Return the installed version, or a note that cbtui is not installed."""
    try:
        return version("cbtui")
    except PackageNotFoundError:
        return "(not installed)"
