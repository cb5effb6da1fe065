"""Joining the namespaces that groups and nodes give."""

import re

from sim.launch.errors import LaunchFailure

_NAMESPACE = re.compile(r"/?([A-Za-z_]\w*(/[A-Za-z_]\w*)*)?")


def joined(base: str, namespace: str) -> str:
    """``namespace`` inside of ``base``; one that begins with a slash stands alone.

    Raises:
        LaunchFailure: it is no namespace.
    """
    namespace = namespace.rstrip("/") if len(namespace) > 1 else namespace
    if not _NAMESPACE.fullmatch(namespace):
        raise LaunchFailure(f"the namespace {namespace!r} is not made of letters, digits, '_' and '/'")
    if not namespace or namespace.startswith("/"):
        return namespace or base
    return f"{base.rstrip('/')}/{namespace}"
