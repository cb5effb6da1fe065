"""The inputs of a run of before, read from its events so that they can be given again."""

from collections.abc import Iterable

import msgspec

from sim.engine import commands
from sim.engine.setup import TimedInput
from sim.trace.events import AnyEvent, InputGiven


class UnknownInputError(Exception):
    """An input that this version cannot give; the text is a sentence."""


def inputs_of(events: Iterable[AnyEvent]) -> tuple[TimedInput, ...]:
    """What was told to a run from outside, in order.

    A repetition on the virtual clock, with the same set-up besides, has the events of the run, but for those
    that tell what was done to its time and what its prompt completed.

    Raises:
        UnknownInputError: one of them is none that this version knows.
    """
    found = tuple(
        TimedInput(event.t, event.command, event.recess) for event in events if isinstance(event, InputGiven)
    )
    for each in found:
        try:
            commands.input_of(each.command)
        except msgspec.DecodeError:
            moment = each.at / 1e9
            raise UnknownInputError(f"this version does not know the input given at {moment:.3f} s") from None
    return found


def stops(given: TimedInput) -> bool:
    """Whether the input ended the run."""
    return isinstance(commands.input_of(given.command), commands.Stop)
