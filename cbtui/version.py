"""The version of cbtui."""


def own_version() -> str:
    """Return the installed version, or a note that cbtui is not installed."""
    from importlib.metadata import PackageNotFoundError, version  # slow to import, and seldom asked

    try:
        return version("cbtui")
    except PackageNotFoundError:
        return "(not installed)"
