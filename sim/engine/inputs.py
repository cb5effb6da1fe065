"""The inputs of an earlier run, read from its events to repeat them."""

from collections.abc import Iterable

import msgspec

from sim.engine import commands
from sim.engine.setup import TimedInput
from sim.trace.events import AnyEvent, InputGiven


class UnknownInputError(Exception):
    """An input that this version does not know; the text is a sentence."""


def inputs_of(events: Iterable[AnyEvent]) -> tuple[TimedInput, ...]:
    """Return the inputs that a run got from outside, in order.

    A repetition on the virtual clock, with these inputs and otherwise the same set-up, has the same events,
    except those about changes of its pace and completions at its prompt.

    Raises:
        UnknownInputError: this version does not know one of them.
    """
    found = tuple(
        TimedInput(event.t, event.command, event.recess) for event in events if isinstance(event, InputGiven)
    )
    for each in found:
        try:
            commands.input_of(each.command)
        except msgspec.DecodeError:
            moment = each.at / 1e9
            raise UnknownInputError(
                f"this version of cbtui does not know the input given at {moment:.3f} s"
            ) from None
    return found


def stops(given: TimedInput) -> bool:
    """Whether the input ended the run."""
    return isinstance(commands.input_of(given.command), commands.Stop)
