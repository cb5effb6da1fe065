"""Tries a cure in the background: runs with and without it, on virtual time at full speed."""

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
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
from sim.diagnosis.words import who
from sim.engine.setup import RunSetup, TimedInput
from sim.files.untrusted import MAX_PROGRAM_BYTES, read_text
from sim.quantities.nanoseconds import SECOND
from sim.quantities.plural import counted
from sim.trace.events import Doing, EntityId
from sim.trace.model import Nanoseconds, Window
from sim.trace.timeline import Timeline

_LIMIT = 15.0
"""Real seconds after which a run is given up."""

_TIME_STOOD_STILL = (
    "Whether a cure helps is not known: cures are tried on virtual time, which stands still while the loop "
    "computes, so what would end the loop does not come."
)
_NOT_SHOWN = "Whether a cure helps is not known: the run that was made to try one did not show this problem."
_TOO_SLOW = (
    "Whether a cure helps is not known: the run with it did not get far enough in the time it was given."
)

NOTICED: Nanoseconds = 2 * SECOND
"""How long after it began a problem is known as one."""

Problem: TypeAlias = tuple[str, str, str]
"""A rule's id, its subject and its culprit, by name: comparable between runs of a program."""

_COMPUTES = "still-computing"
_LOOPS, _WAITS = "stays-in-loop", "endless-wait"
_CRASH = "program-raised"
_TOO_MANY_CALLS = (
    "always-due",
    "triggers-itself",
    "falls-behind",
    "service-falls-behind",
    "never-destroyed",
)
"""Problems of callbacks that are to be called less often."""

_NAMES = {
    "program-raised": "exception",
    "qos-mismatch": "QoS mismatch",
    "stays-in-loop": "long loop",
    "nobody-offers": "service that nobody offers",
    "service-never-comes": "wait for a service",
    "waited-in-vain": "wait for a service in vain",
    "node-never-spins": "node that nobody spins",
    "spin-raised": "exception that ends spin()",
    "overrun-timer": "callback longer than its timer's period",
    "falls-behind": "callback slower than its messages",
    "group-starvation": "wait for a group",
    "no-free-worker": "no free thread",
    "behind-others": "wait behind others",
    "always-due": "timer of period 0",
    "triggers-itself": "guard condition that triggers itself",
    "times-kept": "times of a clock that was set back",
    "clock-never-starts": "clock that never starts",
    "never-destroyed": "timers or the like that pile up",
    "never-synchronised": "synchroniser that never fires",
    "unreturned-response": "missing answer",
    "reply-awaits-in-vain": "await in a service that does not end",
    "spin-past-executor": "spin of another executor",
    "lookup-keeps-transform": "lookup that keeps out its transform",
}
"""Problems whose rule has another name in sentences."""


@dataclass(frozen=True)
class TriedRun:
    """The problems of a run, each with whether it lasts for ever; ``is_whole`` if the run reached its end.

    ``effects`` are rules and subjects of what was only an effect of a problem; ``names`` are the problems'
    names in sentences, and ``since`` when each was there. ``end`` is its length; ``is_cut``: it was given up
    there because it took long, and would have gone on.
    """

    problems: Mapping[Problem, bool]
    is_whole: bool = True
    effects: frozenset[tuple[str, str]] = frozenset()
    names: Mapping[Problem, str] = field(default_factory=dict)
    end: Nanoseconds = 0
    is_cut: bool = False
    since: Mapping[Problem, Nanoseconds] = field(default_factory=dict)
    calls: Mapping[str, int] = field(default_factory=dict)
    """The number of calls of each callback, by its name."""
    next_cures: "tuple[Cure, ...]" = ()
    """The cures of its first problem, on top of the changes that it was made with."""

    @property
    def badness(self) -> tuple[int, int]:
        """A rank, greater for worse: first endless problems and an early end count, then all problems."""
        return sum(self.problems.values()) + (not (self.is_whole or self.is_cut)), len(self.problems)


@dataclass(frozen=True)
class Verdict:
    """What a trial of a cure told: whether the cure helps, None if that stays unknown for ``reason``.

    ``instead`` is the name of the problem that comes with the cure in place of the one that it ends.
    """

    helps: bool | None
    instead: str = ""
    reason: str = _NOT_SHOWN
    both: "Cure | None" = None
    """This cure and another one, if only both together help."""

    @property
    def exchange(self) -> str:
        """Say that one problem is gone and another one comes; "" if none does."""
        return self.instead and f"with it this problem is gone, and another one comes: {self.instead}"


@dataclass(frozen=True)
class Cure:
    """A change of a run that can be tried, in words.

    ``diff`` is what ``diff -u`` writes about an edit; ``code`` are the statements for all other changes.
    ``again``: it leaves the callback's work to its further calls.
    """

    changes: Changes
    words: str
    diff: str = ""
    code: tuple[str, ...] = ()
    again: bool = False

    @property
    def key(self) -> str:
        """What two cures of one run have in common that change the same."""
        return f"{self.words}\n{self.diff}"


def problem_of(found: Finding, timeline: Timeline) -> Problem:
    """Return what identifies a finding in other runs; in a deadlock either side may be the subject.

    Which rule finds a call that stays in its loop depends on the clock, and on how long it has been there.
    """
    sides = found.subject, found.culprit or found.subject
    one, other = sorted(_name_of_callback(each, timeline) for each in sides)
    if found.rule.id != _LOOPS:
        return found.rule.id, one, other
    at = timeline.positions_of(found.subject, Window(found.until, found.until + 1))
    return _WAITS if any(each.doing is Doing.WAITS for each in at) else _COMPUTES, one, other


def _name_of_callback(entity: EntityId, timeline: Timeline) -> str:
    known = timeline.entities.get(entity)
    return "" if known is None else known.spoken_name


def name_of(found: Finding, explained: Explanation) -> str:
    """Return what a problem is called in sentences."""
    if explained.for_ever:
        return "deadlock" if found.waited_for or "deadlock" in explained.what else "hang"
    return _NAMES.get(found.rule.id, found.rule.id.replace("-", " "))


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
            yield Cure(changes, remedy.words(timeline), edited, again=remedy.again)


def both(first: Cure, then: Cure, before: Changes) -> Cure:
    """Return a cure and one of a run with it as one cure of the run ``before`` both."""
    texts = {file: before.texts.get(file) or text_of(Path(file)) for file in then.changes.texts}
    edits = (diff(file, old, then.changes.texts[file]) for file, old in texts.items())
    return Cure(then.changes, f"{first.words}; {then.words}", "".join(edits), again=first.again or then.again)


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


def judged(problem: Problem, before: TriedRun, after: TriedRun, *, again: bool = False) -> Verdict:
    """Tell whether a cure ends a problem of the run ``before`` without a worse one in its place.

    An effect of the problem before does not count if it remains as a problem of its own. After an exception
    that ended the run, whatever else the program does wrong has its turn, and so has what a callback does
    that had never run, unless that lasts for ever. A problem does not end if its callbacks are merely called
    less often, or, if the cure leaves their work to further calls ``again``, get none.
    """
    if problem not in before.problems:
        return Verdict(None)
    if any(lasts and name == _COMPUTES for (name, *_), lasts in after.problems.items()):
        return Verdict(None, reason=_TIME_STOOD_STILL)
    if problem in after.problems:
        return Verdict(False)
    if after.is_cut and after.end < before.since.get(problem, 0) + NOTICED:
        return Verdict(None, reason=_TOO_SLOW)
    left = {
        each: lasts
        for each, lasts in after.problems.items()
        if before.effects.isdisjoint((each[0], name) for name in each[1:])
    }
    new = sorted((each for each in left if each not in before.problems), key=lambda each: not left[each])
    instead = after.names.get(new[0], "") if new else ""
    if problem[0] == _CRASH and not before.is_whole and (after.is_whole or after.end > before.end):
        return Verdict(True, instead)
    goes_on = after.is_whole or after.is_cut
    idle = _called_less(problem, before, after, again)
    comes_to_light = new and all(not left[each] and _runs_only(each, before, after) for each in new)
    is_better = comes_to_light or replace(after, problems=left).badness < before.badness
    return Verdict(bool(goes_on and not idle and is_better), idle or instead)


def _runs_only(problem: Problem, before: TriedRun, after: TriedRun) -> bool:
    """Return whether one of a problem's callbacks ran in the run ``after`` alone."""
    return any(before.calls.get(name, 0) == 0 < after.calls.get(name, 0) for name in problem[1:])


def _called_less(problem: Problem, before: TriedRun, after: TriedRun, again: bool) -> str:
    """Tell of a problem's callback that is called less often, by more than the run's end may cut off."""
    for name in problem[1:]:
        was, now = (each.calls.get(name, 0) for each in (before, after))
        if again and 0 < now <= was:
            return f"{name} is not called again"
        if now < was - 1 and after.end >= before.end and problem[0] not in _TOO_MANY_CALLS:
            return f"{name} is called less often, {counted(now, 'time')} in place of {was}"
    return ""


def tried_in_vain(tried: Sequence[tuple[Cure, Verdict]]) -> str:
    """Return a sentence on cures of which none helps, or of which that is not known."""
    for _, verdict in tried:
        if verdict.helps is None:
            return verdict.reason
    none = "none helps" if len(tried) > 1 else "it does not help"
    if any(verdict.instead for _, verdict in tried):
        none = "none is enough" if len(tried) > 1 else "it is not enough"
    words = (
        f"{cure.words} ({verdict.exchange})" if verdict.instead else cure.words for cure, verdict in tried
    )
    return f"{counted(len(tried), 'cure')} tried, {none} here: {'; '.join(words)}."


def try_run(
    setup: RunSetup,
    until: Nanoseconds,
    given_up: Event,
    note: Callable[[Nanoseconds], object] = lambda _: 0,
    *,
    clock: str = "virtual",
    changes: Changes | None = None,
) -> TriedRun:
    """Make a run and return its problems. ``note`` gets its progress in nanoseconds.

    With the changes that the set-up has, it is also told what could be tried next.

    Raises:
        GivenUpError: ``given_up`` was set meanwhile.
        OSError: the engine could not be started.
    """
    timeline = Timeline(until_ending=True)
    unwatched = msgspec.structs.replace(setup, clock=clock, speed=None, until=until)
    is_cut = False
    with FollowedRun(unwatched, ProcessSession, given_up) as run, suppress(EngineLostError):
        try:
            run.start()
            run.limit(_LIMIT)
            for batch in run:
                timeline.extend(batch)
                note(timeline.end)
        except RunTimeoutError:
            is_cut = True
    found = diagnose(timeline)
    wrong = [each for each in found if each.weight_in(timeline) is Weight.PROBLEM]
    told = {problem_of(each, timeline): (each, each.explained(timeline)) for each in wrong}
    lasts = {problem: explained.for_ever for problem, (_, explained) in told.items()}
    names = {problem: name_of(*each) for problem, each in told.items()}
    effects = {(each.rule.id, _name_of_callback(each.subject, timeline)) for each in found if each.due_to}
    effects -= {(each.rule.id, _name_of_callback(each.subject, timeline)) for each in wrong}
    is_whole = timeline.ended is not None and timeline.ended.time_was_up
    since = {problem: each.at for problem, (each, _) in told.items()}
    calls: Counter[str] = Counter()
    for each in timeline.entities.values():
        calls[each.spoken_name] += len(timeline.calls_begun(each.id, Window(0, timeline.end + 1)))
    further = (
        replace(cure, words=f"for {who(first.subject, timeline)}: {cure.words}")
        for first, explained in list(told.values())[:1]
        if changes is not None and first.subject
        for cure in cures_of(explained, changes, timeline)
    )
    return TriedRun(
        lasts, is_whole, frozenset(effects), names, timeline.end, is_cut, since, calls, (*further,)
    )
