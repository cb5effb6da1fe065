"""The base class of all events."""

from functools import cache

import msgspec

from sim.trace.events.fields import Nanoseconds


class TraceEvent(msgspec.Struct, frozen=True, array_like=True, gc=False):
    """Something that happened in a run.

    A subclass describes one kind of event, and is the only description of it: the types of its fields and
    the texts below them define a line of JSON and the text of ``EVENTS.md``. Events are tiny because a
    callback writes several of them: on the wire each is a MessagePack array that starts with its tag.
    """

    t: Nanoseconds
    """Time since the run began."""


@cache
def kinds() -> tuple[type[TraceEvent], ...]:
    """Every kind of event; ``sim.trace.events`` must have been imported, which imports them all.

    A class outside these modules, which replaces an event until it is packed, is not a kind.
    """
    return tuple(
        each for each in TraceEvent.__subclasses__() if each.__module__.startswith(f"{__package__}.")
    )
