"""The callbacks that wait for others: one answer for every pane and sentence."""

from sim.trace.model import Moment, Nanoseconds, Wait

WORTH_TELLING: Nanoseconds = 10_000_000
"""Shorter waits are the usual hand-over between callbacks, and are not reported."""


def waits_for_others(moment: Moment) -> list[Wait]:
    """Return the waits of a moment that are worth telling and not for a callback's own last call.

    The longest is first.
    """
    waits = (wait for wait in moment.waiting.values() if wait.holder != wait.entity)
    return sorted(
        (wait for wait in waits if moment.at - wait.since >= WORTH_TELLING), key=lambda wait: wait.since
    )
