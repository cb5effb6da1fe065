"""Joins the namespaces of groups and nodes."""

import re

from sim.launch.errors import LaunchFailure

_NAMESPACE = re.compile(r"/?([A-Za-z_]\w*(/[A-Za-z_]\w*)*)?")


def joined(base: str, namespace: str) -> str:
    """Return ``namespace`` inside ``base``, or alone if it begins with a slash.

    Raises:
        LaunchFailure: ``namespace`` is not valid.
    """
    namespace = namespace.rstrip("/") if len(namespace) > 1 else namespace
    if not _NAMESPACE.fullmatch(namespace):
        raise LaunchFailure(f"the namespace {namespace!r} is not made of letters, digits, '_' and '/'")
    if not namespace or namespace.startswith("/"):
        return namespace or base
    return f"{base.rstrip('/')}/{namespace}"
