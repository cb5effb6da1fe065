"""Tries a cure out of sight: the run as it is and with the cure, on virtual time at full speed."""

from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import replace
from threading import Event
from typing import TypeAlias

import msgspec

from cbtui.engines.follow import EngineLostError, FollowedRun, RunTimeoutError
from cbtui.engines.session import ProcessSession
from cbtui.runs.setup.changeable import place_of
from cbtui.runs.setup.changes import Changes
from lessons.checks import problems
from sim.diagnosis import Finding
from sim.diagnosis.cures import Remedy
from sim.engine.setup import RunSetup, TimedInput
from sim.trace.model import Nanoseconds
from sim.trace.timeline import Timeline

_LIMIT = 15.0
"""Real seconds after which a run is given up."""

Problem: TypeAlias = tuple[str, str, str]
"""A rule's id, whom it is about, and whom it blames: the same in several runs of a program."""
Problems: TypeAlias = Mapping[Problem, bool]
"""What is wrong in a run, and whether for ever."""


def problem_of(found: Finding, timeline: Timeline) -> Problem:
    """Return what identifies a finding in other runs."""
    subject, culprit = (
        known.spoken_name if (known := timeline.entities.get(each)) is not None else ""
        for each in (found.subject, found.culprit)
    )
    return found.rule.id, subject, culprit


def changes_of(remedy: Remedy, before: Changes, timeline: Timeline) -> Changes | None:
    """Return the changes of a run with a remedy; None if it has none."""
    changes = before if not remedy.threads else replace(before, threads=remedy.threads)
    for entity in remedy.own_groups:
        changes = changes.with_group(place_of(timeline.entities[entity], timeline), "own")
    return None if changes == before else changes


def with_inputs(setup: RunSetup, inputs: tuple[TimedInput, ...]) -> RunSetup:
    """Return the set-up of a run that also gets the inputs of the one before."""
    return msgspec.structs.replace(setup, inputs=inputs) if inputs else setup


def helps(problem: Problem, before: Problems | None, after: Problems | None) -> bool:
    """Whether a run has a problem, and the same run with a cure has not, nor another one in its place.

    Fewer problems that last for ever make up for others. None stands for a run that did not come to its end.
    """
    if before is None or problem not in before or after is None or problem in after:
        return False
    return (sum(after.values()), len(after)) < (sum(before.values()), len(before))


def problems_in(
    setup: RunSetup, until: Nanoseconds, given_up: Event, note: Callable[[Nanoseconds], object] = lambda _: 0
) -> Problems | None:
    """Return what is wrong in a run; None if it did not come to its end. ``note`` gets how far it is.

    Raises:
        GivenUpError: ``given_up`` was set meanwhile.
        OSError: the engine could not be started.
    """
    timeline = Timeline(until_ending=True)
    unwatched = msgspec.structs.replace(setup, clock="virtual", speed=None, until=until)
    with FollowedRun(unwatched, ProcessSession, given_up) as run, suppress(EngineLostError, RunTimeoutError):
        run.start()
        run.limit(_LIMIT)
        for batch in run:
            timeline.extend(batch)
            note(timeline.end)
    ended = timeline.ended
    if ended is None or not ended.time_was_up:
        return None
    return {
        problem_of(found, timeline): found.rule.explain(found, timeline).for_ever
        for found in problems(timeline)
    }
