"""Turns the changes of a set-up into the overrides that the model applies."""

from sim.engine.setup import RunSetup
from sim.ros.middleware.callback_overrides import CallbackOverrides, GroupChoice


def overrides_of(setup: RunSetup) -> CallbackOverrides | None:
    """Return the overrides; None if the set-up has none.

    Raises:
        ValueError: a group change has an unknown wish.
    """
    if not setup.groups and not setup.periods:
        return None
    return CallbackOverrides(
        {(each.node, each.callback): GroupChoice(each.wish) for each in setup.groups},
        {(each.node, each.callback): each.period for each in setup.periods},
    )
