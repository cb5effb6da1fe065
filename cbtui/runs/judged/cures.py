"""Tries a cure in the background: runs with and without it, on virtual time at full speed."""

from collections.abc import Callable, Iterator, Mapping, Sequence
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
from sim.quantities.plural import counted
from sim.trace.model import Nanoseconds
from sim.trace.timeline import Timeline

_LIMIT = 15.0
"""Real seconds after which a run is given up."""

Problem: TypeAlias = tuple[str, str, str]
"""A rule's id, its subject and its culprit, by name: comparable between runs of a program."""


@dataclass(frozen=True)
class TriedRun:
    """The problems of a run, each with whether it lasts for ever; ``is_whole`` if the run reached its end.

    ``effects`` are the ids of the rules that found only effects of a problem.
    """

    problems: Mapping[Problem, bool]
    is_whole: bool = True
    effects: frozenset[str] = frozenset()

    @property
    def badness(self) -> tuple[int, int]:
        """A rank, greater for worse: first endless problems and an early end count, then all problems."""
        return sum(self.problems.values()) + (not self.is_whole), len(self.problems)


@dataclass(frozen=True)
class Cure:
    """A change of a run that can be tried, in words.

    ``diff`` is what ``diff -u`` writes about an edit; ``code`` are the statements for all other changes.
    """

    changes: Changes
    words: str
    diff: str = ""
    code: tuple[str, ...] = ()


def problem_of(found: Finding, timeline: Timeline) -> Problem:
    """Return what identifies a finding in other runs; in a deadlock either side may be the subject."""
    one, other = sorted(
        known.spoken_name if (known := timeline.entities.get(each)) is not None else ""
        for each in (found.subject, found.culprit)
    )
    return found.rule.id, one, other


def cures_of(explanation: Explanation, before: Changes, timeline: Timeline) -> Iterator[Cure]:
    """Yield the remedies of an explanation that can be tried on a run with changes."""
    for remedy in explanation.remedies:
        changes, edited = _without_edit(remedy, before, timeline), ""
        if remedy.edit is not None:
            file = remedy.edit.file
            text = before.texts.get(file) or text_of(Path(file))
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


def text_of(path: Path) -> str:
    """Return the text of a program's file; "" if it cannot be read, or is none."""
    with suppress(OSError, UnicodeDecodeError):
        return read_text(path, MAX_PROGRAM_BYTES)
    return ""


def with_inputs(setup: RunSetup, inputs: tuple[TimedInput, ...]) -> RunSetup:
    """Return the set-up with the inputs of an earlier run."""
    return msgspec.structs.replace(setup, inputs=inputs) if inputs else setup


def helps(problem: Problem, before: TriedRun, after: TriedRun) -> bool:
    """Tell whether a cure ends a problem of the run ``before`` without a worse one in its place.

    An effect of the problem before does not count if it remains as a problem of its own.
    """
    left = {each: lasts for each, lasts in after.problems.items() if each[0] not in before.effects}
    return (
        problem in before.problems
        and after.is_whole
        and problem not in after.problems
        and replace(after, problems=left).badness < before.badness
    )


def tried_in_vain(cures: Sequence[Cure], *, is_known: bool) -> str:
    """Return a sentence on cures of which none helps, or of which that is not known."""
    if not is_known:
        return (
            "Whether a cure helps is not known: the run that was made to try one did not show this problem."
        )
    none = "none helps" if len(cures) > 1 else "it does not help"
    return f"{counted(len(cures), 'cure')} tried, {none} here: {'; '.join(each.words for each in cures)}."


def try_run(
    setup: RunSetup, until: Nanoseconds, given_up: Event, note: Callable[[Nanoseconds], object] = lambda _: 0
) -> TriedRun:
    """Make a run and return its problems. ``note`` gets its progress in nanoseconds.

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
