"""Timelines and pictures that the tests of the widgets share."""

from collections.abc import Iterable
from textwrap import dedent

from cbtui.looks.theme import TextRun
from sim.trace.model import Nanoseconds, Window
from sim.trace.timeline import Timeline
from tests.support.runs import Run, ns


def told(run: Run, until: float = 1e9) -> Timeline:
    """Return the timeline of a run as far as it has been told at ``until`` seconds."""
    timeline = Timeline()
    timeline.extend(event for event in run.events if event.t <= ns(until))
    return timeline


def last(seconds: float, now: float) -> tuple[Window, Nanoseconds]:
    """Return the window of so many seconds before ``now``, and ``now``."""
    return Window(ns(now) - ns(seconds), ns(now)), ns(now)


def drawn(text: str) -> str:
    """Return a picture written in a test: each line stands between bars so that blanks at its end count."""
    return "\n".join(line[1:-1] for line in dedent(text).strip("\n").splitlines())


def plain(rows: Iterable[Iterable[TextRun]]) -> str:
    """Return painted rows as text without inks."""
    return "\n".join("".join(run.text for run in row) for row in rows)
