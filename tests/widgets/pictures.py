"""Timelines and pictures that the tests of the widgets share."""

from collections.abc import Callable, Iterable
from functools import cache
from textwrap import dedent
from typing import Protocol

from cbtui.looks.theme import TextRun
from sim.trace.model import Nanoseconds, Window
from sim.trace.timeline import Timeline
from tests.support.runs import (
    Run,
    dummy_server_one_thread_run,
    dummy_server_run,
    ns,
    shared_group_run,
    split_groups_run,
)


def told(run: Run, until: float = 1e9) -> Timeline:
    """Return the timeline of a run as far as it has been told at ``until`` seconds."""
    timeline = Timeline()
    timeline.extend(event for event in run.events if event.t <= ns(until))
    return timeline


class _Told(Protocol):
    """Returns a timeline that nobody extends, as far as it has been told at so many seconds."""

    def __call__(self, until: float = ..., /) -> Timeline: ...


def _told_once(play: Callable[[], Run]) -> _Told:
    """Tell each run a single time, and when it is first asked for: a hundred tests look at the same ones."""
    return cache(lambda until=1e9: told(play(), until))


shared_group = _told_once(shared_group_run)
split_groups = _told_once(split_groups_run)
dummy_server = _told_once(dummy_server_run)
dummy_server_one_thread = _told_once(dummy_server_one_thread_run)


def last(seconds: float, now: float) -> tuple[Window, Nanoseconds]:
    """Return the window of so many seconds before ``now``, and ``now``."""
    return Window(ns(now) - ns(seconds), ns(now)), ns(now)


def drawn(text: str) -> str:
    """Return a picture written in a test: each line stands between bars so that blanks at its end count."""
    return "\n".join(line[1:-1] for line in dedent(text).strip("\n").splitlines())


def plain(rows: Iterable[Iterable[TextRun]]) -> str:
    """Return painted rows as text without inks."""
    return "\n".join("".join(run.text for run in row) for row in rows)
