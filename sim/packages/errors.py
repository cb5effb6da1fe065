"""Errors of packages, each with a sentence for the learner."""


class PackageError(Exception):
    """A package cannot be read, or does not have the requested item; the text says what and where."""


class UnknownPackageError(PackageError, LookupError):
    """There is no package of that name."""


class UnknownExecutableError(PackageError, LookupError):
    """The package has no executable of that name."""


def listing(what: str, names: list[str]) -> str:
    """Return an enumeration such as ``known packages: a, b``, or ``no known packages``."""
    return f"{what}: {', '.join(names)}" if names else f"no {what}"
