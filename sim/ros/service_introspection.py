"""Watching a service's calls on a topic of its own, which is not supported."""

from enum import IntEnum


class ServiceIntrospectionState(IntEnum):
    """How much of every call is told."""

    OFF = 0
    METADATA = 1
    CONTENTS = 2


def require_off(owner: str, introspection_state: ServiceIntrospectionState) -> None:
    """Raise NotImplementedError for anything but OFF."""
    if introspection_state != ServiceIntrospectionState.OFF:
        raise NotImplementedError(f"{owner}.configure_introspection is not supported")
