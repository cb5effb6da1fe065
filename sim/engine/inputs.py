"""The inputs of a run of before, read from its events so that they can be given again."""

from collections.abc import Iterable

import msgspec

from sim.engine import commands
from sim.engine.setup import TimedInput
from sim.trace.events import AnyEvent, InputGiven


class UnknownInputError(Exception):
    """An input that this version cannot give; the text is a sentence."""


def inputs_of(events: Iterable[AnyEvent]) -> tuple[TimedInput, ...]:
    """The inputs that a run got from outside, in order.

    A repetition on the virtual clock, with these inputs and otherwise the same set-up, has the same events,
    except those about changes of its pace and completions at its prompt.

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
