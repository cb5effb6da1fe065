"""Tries a cure out of sight: the run as it is and with the cure, on virtual time at full speed."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from threading import Event
from typing import TypeAlias

import msgspec

from cbtui.engines.follow import EngineLostError, FollowedRun, RunTimeoutError
from cbtui.engines.session import ProcessSession
from cbtui.runs.setup.changeable import place_of
from cbtui.runs.setup.changes import Changes
from sim.diagnosis import Explanation, Finding, Weight, diagnose
from sim.diagnosis.cures import Remedy
from sim.diagnosis.edits.code_edit import diff
from sim.engine.setup import RunSetup, TimedInput
from sim.files.untrusted import MAX_PROGRAM_BYTES, read_text
from sim.trace.model import Nanoseconds
from sim.trace.timeline import Timeline

_LIMIT = 15.0
"""Real seconds after which a run is given up."""

Problem: TypeAlias = tuple[str, str, str]
"""A rule's id, its subject and its culprit, by name: comparable between runs of a program."""


@dataclass(frozen=True)
class TriedRun:
    """What is wrong in a run, and whether for ever; ``is_whole`` if it came to its end.

    ``effects`` are the rules that found nothing but what a problem brings about.
    """

    problems: Mapping[Problem, bool]
    is_whole: bool = True
    effects: frozenset[str] = frozenset()

    @property
    def badness(self) -> tuple[int, int]:
        """How bad it is: fewer problems that last for ever make up for others, and so does no crash."""
        return sum(self.problems.values()) + (not self.is_whole), len(self.problems)


@dataclass(frozen=True)
class Cure:
    """A change of a run that can be tried: in words, and what it edits, as ``diff -u`` writes it."""

    changes: Changes
    words: str
    diff: str = ""


def problem_of(found: Finding, timeline: Timeline) -> Problem:
    """Return what identifies a finding in other runs: of a deadlock, either side may be the last to wait."""
    one, other = sorted(
        known.spoken_name if (known := timeline.entities.get(each)) is not None else ""
        for each in (found.subject, found.culprit)
    )
    return found.rule.id, one, other


def cures_of(told: Explanation, setup: RunSetup, before: Changes, timeline: Timeline) -> Iterator[Cure]:
    """Yield what can be tried of an explanation's cure, for a run of a set-up with changes.

    A program's own file may be edited, not a module that it imports.
    """
    for remedy in told.remedies:
        changes, edited = _without_edit(remedy, before, timeline), ""
        if remedy.edit is not None:
            file = remedy.edit.file
            if all(each.path != file for each in setup.programs):
                continue
            text = before.texts.get(file) or _text_of(Path(file))
            new = remedy.edit.applied(text)
            if new is None:
                continue
            changes, edited = replace(changes, texts={**before.texts, file: new}), diff(file, text, new)
        if changes != before:
            yield Cure(changes, remedy.words(timeline), edited)


def _without_edit(remedy: Remedy, before: Changes, timeline: Timeline) -> Changes:
    changes = before if not remedy.threads else replace(before, threads=remedy.threads)
    for entity in remedy.own_groups:
        changes = changes.with_group(place_of(timeline.entities[entity], timeline), "own")
    return changes


def _text_of(path: Path) -> str:
    """The text of a program's file; "" if it cannot be read, or is none."""
    with suppress(OSError, UnicodeDecodeError):
        return read_text(path, MAX_PROGRAM_BYTES)
    return ""


def with_inputs(setup: RunSetup, inputs: tuple[TimedInput, ...]) -> RunSetup:
    """Return the set-up of a run that also gets the inputs of the one before."""
    return msgspec.structs.replace(setup, inputs=inputs) if inputs else setup


def helps(problem: Problem, before: TriedRun, after: TriedRun) -> bool:
    """Whether a run has a problem, and the same run with a cure has not, nor a worse one in its place.

    What was an effect of the problem before, and is told for itself without it, is none in its place.
    """
    left = {each: lasts for each, lasts in after.problems.items() if each[0] not in before.effects}
    return (
        problem in before.problems
        and after.is_whole
        and problem not in after.problems
        and replace(after, problems=left).badness < before.badness
    )


def tried(
    setup: RunSetup, until: Nanoseconds, given_up: Event, note: Callable[[Nanoseconds], object] = lambda _: 0
) -> TriedRun:
    """Return what is wrong in a run. ``note`` gets how far it is.

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
    found = diagnose(timeline)
    wrong = [each for each in found if each.rule.weigh(each, timeline) is Weight.PROBLEM]
    lasts = {problem_of(each, timeline): each.rule.explain(each, timeline).for_ever for each in wrong}
    effects = {each.rule.id for each in found if each.due_to} - {each.rule.id for each in wrong}
    is_whole = timeline.ended is not None and timeline.ended.time_was_up
    return TriedRun(lasts, is_whole, frozenset(effects))
