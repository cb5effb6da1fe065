"""What can be wrong with a package, each in one sentence for the learner."""


class PackageError(Exception):
    """A package that cannot be read or lacks what was asked for; the text says what and where."""


class UnknownPackageError(PackageError, LookupError):
    """There is no package of that name."""


class UnknownExecutableError(PackageError, LookupError):
    """The package has no executable of that name."""


def listing(what: str, names: list[str]) -> str:
    """``known packages: a, b``, or that there are none."""
    return f"{what}: {', '.join(names)}" if names else f"no {what}"
