"""Turns the changes of a set-up into the tuning of the model."""

from sim.engine.setup import RunSetup
from sim.ros.middleware.tuning import GroupChoice, Tuning


def tuning_of(setup: RunSetup) -> Tuning | None:
    """Return what is changed about the programs, None for nothing.

    Raises:
        ValueError: a wish that there is not.
    """
    if not setup.groups and not setup.periods:
        return None
    return Tuning(
        {(each.node, each.callback): GroupChoice(each.wish) for each in setup.groups},
        {(each.node, each.callback): each.period for each in setup.periods},
    )
