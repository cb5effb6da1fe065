"""Functions for checks and answers: callbacks of a run by their names, their calls, and stretches of time."""

from collections.abc import Callable
from dataclasses import dataclass

from sim.quantities.nanoseconds import SECOND, nearest_ns
from sim.trace.events import EntityId
from sim.trace.figures.summary import turns_among
from sim.trace.model import Call, Nanoseconds, Span, Window
from sim.trace.timeline import Timeline


def whole_run(run: Timeline) -> Window:
    """Return the window of a whole run."""
    return Window(0, run.end + 1)


def entities_named(run: Timeline, name: str) -> list[EntityId]:
    """Return the entities of a callback (``scan_callback``), or of a topic or service (``/scan``)."""
    return [each.id for each in run.entities.values() if name in (each.callback, each.name)]


def calls_of(run: Timeline, name: str, window: Window | None = None) -> list[Span]:
    """Return the calls of a callback, topic or service by their starts; with ``window`` those begun in it."""
    within = whole_run(run) if window is None else window
    found = [span for each in entities_named(run, name) for span in run.calls_begun(each, within)]
    return sorted(found, key=lambda span: span.start)


def spans_of(run: Timeline, name: str) -> list[Span]:
    """Return the spans of a callback, topic or service; a call that awaits something has several."""
    found = [span for each in entities_named(run, name) for span in run.spans_of(each, whole_run(run))]
    return sorted(found, key=lambda span: span.start)


def requests_of(run: Timeline, service: str) -> list[Call]:
    """Return the calls of a service in the order in which they were sent."""
    return [call for call in run.calls if call.service == service]


@dataclass(frozen=True, slots=True)
class Stretch:
    """A condition that holds at some times of a run; ``words`` follow the word "while"."""

    words: str
    windows: Callable[[Timeline], list[Window]]


WHOLE_RUN = Stretch("the run lasts", lambda run: [whole_run(run)])
"""From a run's beginning to its end."""


def rotations(run: Timeline) -> list[Window]:
    """Return the times when the robot turned: from each command to turn to the first other command."""
    return list(turns_among(run.commands(whole_run(run)), None, Window(0, run.end)))


ROTATES = Stretch("the robot rotates", rotations)
"""While the robot is under a command to turn."""


def runs_long(callback: str, seconds: float = 1.0) -> Stretch:
    """While a callback is in a call of a least length in seconds."""

    def windows(run: Timeline) -> list[Window]:
        every = (Window(span.start, span.end_at(run.end)) for span in spans_of(run, callback))
        return [window for window in every if window.length >= nearest_ns(seconds)]

    return Stretch(f"{callback} runs", windows)


def is_called(service: str) -> Stretch:
    """While a call of a service is without its answer."""

    def windows(run: Timeline) -> list[Window]:
        ends = (
            (call, run.end if call.replied is None else call.replied) for call in requests_of(run, service)
        )
        return [Window(call.sent, end) for call, end in ends]

    return Stretch(f"{service} works on a request", windows)


def seconds(length: Nanoseconds, unlike: float | None = None) -> str:
    """Return a duration as short text: ``9.9 s``, ``35 ms``.

    It has as many digits as tell it from ``unlike``, a limit in seconds: ``0.1003 s`` for one of 0.1.
    """
    limit = length if unlike is None else nearest_ns(unlike)
    digits = 3
    while limit != length and _rounded(length, digits) == _rounded(limit, digits):
        digits += 1
    return _rounded(length, digits)


def _rounded(length: Nanoseconds, digits: int) -> str:
    if 0 < length < SECOND // 10:
        return f"{length / 1e6:.{digits}g} ms"
    return f"{length / SECOND:.{digits}g} s"
