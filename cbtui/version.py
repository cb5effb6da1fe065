"""Which version of cbtui this is."""

from importlib.metadata import PackageNotFoundError, version


def own_version() -> str:
    """The version that is installed, or that none is."""
    try:
        return version("cbtui")
    except PackageNotFoundError:
        return "(not installed)"
