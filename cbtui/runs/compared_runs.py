"""Two runs to compare, each a recording, a lesson or a file: they are read or run to their end."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from threading import Event
from typing import TypeAlias

from cbtui.engines.follow import EngineLostError, FollowedRun, GivenUpError
from cbtui.engines.session import ProcessSession
from cbtui.runs.judged.compared_problems import ComparedProblems
from cbtui.runs.live.live_run import ShownRun
from cbtui.runs.recorded.repeat import CannotRepeatError, repeated_setup
from cbtui.runs.setup.changes import Changes
from cbtui.runs.setup.lesson_setup import RunRequest
from cbtui.terminal.progress_line import ProgressLine
from cbtui.text.output import complain, say
from sim.engine.setup import RunSetup
from sim.quantities.nanoseconds import SECOND, nearest_ns
from sim.recording import RecordingError, read
from sim.trace.events import NoticeKind
from sim.trace.figures.compared_groups import lettered_alike
from sim.trace.figures.comparison import compare, covered
from sim.trace.figures.comparison_text import comparison_lines, comparison_text
from sim.trace.incremental import run_to_end
from sim.trace.model import Nanoseconds, Window
from sim.trace.timeline import Timeline

LENGTH = 60 * SECOND
"""Default length of runs in nanoseconds."""


class CannotCompareError(Exception):
    """Two runs cannot be compared; the text is a sentence."""


@dataclass(frozen=True)
class ComparedRun:
    """One of two runs: a recording's path, or a run request."""

    name: str
    what: Path | RunRequest

    @property
    def service(self) -> str:
        """The service that has a lane before its first call; "" for none."""
        lesson = self.what.lesson if isinstance(self.what, RunRequest) else None
        return "" if lesson is None else lesson.service.name


@dataclass(frozen=True)
class ComparisonTerms:
    """The window of a comparison, and the inputs of the runs that are made for it.

    ``start`` and ``end`` bound the window; it ends no later than the shorter run, and runs are made to its
    end. ``calls`` are when the SetBool service is called, ``lines`` ``ros2`` lines with their moments;
    ``inputs`` is a recording whose inputs are given instead of them. Times are seconds.
    """

    start: float = 0
    end: float | None = None
    calls: Sequence[float] = ()
    lines: Sequence[tuple[float, str]] = ()
    inputs: Path | None = None


def _never() -> bool:
    return False


@dataclass(frozen=True)
class ComparedSide:
    """One side of a comparison: its name and timeline.

    ``alive`` tells whether the timeline still grows. ``service`` has a lane before its first call. ``damage``
    is a sentence on the unreadable part of a recording or on missing inputs.
    """

    name: str
    timeline: Timeline
    service: str = ""
    alive: Callable[[], bool] = _never
    damage: str | None = None

    def ended(self) -> "ComparedSide":
        """Return a copy whose timeline no longer grows."""
        return replace(self, alive=_never)

    @property
    def failure(self) -> str | None:
        """A sentence on how the run failed; None if it did not."""
        ended = self.timeline.ended
        if ended is None or not ended.failed:
            return None
        return (
            ended.reason if ended.reason.startswith(Path(self.name).name) else f"{self.name}: {ended.reason}"
        )


@dataclass(frozen=True)
class RunProgress:
    """Progress of a run or a recording in nanoseconds; ``until`` is None if its length is unknown."""

    name: str
    doing: str
    at: Nanoseconds
    until: Nanoseconds | None = None

    @property
    def text(self) -> str:
        """The progress as one line."""
        until = "" if self.until is None else f" of {self.until / SECOND:g} s"
        return f"{self.doing} {self.name}: {self.at / SECOND:.1f} s{until}"


Tell: TypeAlias = Callable[[RunProgress], None]


@dataclass(frozen=True)
class RunPair:
    """Both runs, and the part of the requested window that both cover."""

    first: ComparedSide
    second: ComparedSide
    window: Window


def compared_side(run: ShownRun, changes: Changes, edit: str = "") -> ComparedSide:
    """Return a run on screen as a side, named by its ``changes``, in which the two runs differ.

    ``edit`` tells which side of an edit of a file it is on, if one came between the runs.
    """
    service = run.setup.service
    words = ", ".join(filter(None, (changes.words, edit))) or "as written"
    return ComparedSide(
        f"{run.setup.title}, {words}",
        run.timeline,
        "" if service is None else service.name,
        alive=lambda: run.alive,
    )


def compare_runs(
    first: ComparedRun, second: ComparedRun, terms: ComparisonTerms, *, in_lines: bool = False
) -> int:
    """Print the comparison as a table; with ``in_lines`` as sentences, and without a progress line.

    Returns the exit code: 0 on success, 1 if a run failed, 2 if there is no comparison.
    """
    try:
        with ProgressLine() as line:
            tell = (lambda _: None) if in_lines else (lambda at: line.show(at.text))
            found = load_runs(first, second, terms, tell, Event())
    except CannotCompareError as error:
        complain(str(error))
        return 2
    one, other = found.first, found.second
    alike = run_to_end(lettered_alike(one.timeline, other.timeline, other.timeline))
    compared = compare(one.timeline, alike, found.window)
    problems = ComparedProblems(one.timeline, other.timeline).compared(compared)
    if in_lines:
        lines = comparison_lines(compared, one.name, other.name, problems)
        say("".join(f"{line}\n" for line in lines))
    else:
        say(comparison_text(compared, one.name, other.name, problems))
    failures = [side.failure for side in (one, other) if side.failure is not None]
    for sentence in dict.fromkeys([one.damage, other.damage, *failures]):
        if sentence is not None:
            complain(sentence)
    return 1 if failures else 0


def load_runs(
    first: ComparedRun, second: ComparedRun, terms: ComparisonTerms, tell: Tell, given_up: Event
) -> RunPair:
    """Read recordings and make the other runs, on the caller's thread.

    Raises:
        CannotCompareError: one cannot be read or run, or nothing is left to compare.
        GivenUpError: ``given_up`` was set meanwhile.
    """
    known = [
        _recorded(each.name, each.what, tell, given_up) if isinstance(each.what, Path) else None
        for each in (first, second)
    ]
    until = _until([side.timeline.end for side in known if side is not None], terms, tell, given_up)
    _check(terms, until)
    one, other = (
        side or _run(each, terms, until, tell, given_up)
        for each, side in zip((first, second), known, strict=True)
    )
    end = min(until, covered(one.timeline), covered(other.timeline))
    if end <= nearest_ns(terms.start):
        side = min(one, other, key=lambda each: covered(each.timeline))
        why = "" if side.timeline.ended is None else f": {side.timeline.ended.reason}"
        raise CannotCompareError(
            f"nothing is left to compare, {side.name} ended at {covered(side.timeline) / SECOND:g} s{why}"
        )
    return RunPair(one, other, Window(nearest_ns(terms.start), end))


def _until(lengths: list[Nanoseconds], terms: ComparisonTerms, tell: Tell, given_up: Event) -> Nanoseconds:
    """The end of the comparison: the requested one, that of the shorter recording, or that of the inputs."""
    if terms.end is not None:
        return min([nearest_ns(terms.end), *lengths])
    if not lengths and terms.inputs is not None:
        return _recorded(str(terms.inputs), terms.inputs, tell, given_up).timeline.end
    return min(lengths, default=LENGTH)


def _check(terms: ComparisonTerms, until: Nanoseconds) -> None:
    end = until / SECOND
    if end <= terms.start:
        raise CannotCompareError(f"nothing is left to compare from {terms.start:g} s to {end:g} s")
    moments = [("call", at) for at in terms.calls] + [("line", at) for at, _ in terms.lines]
    for what, at in moments:
        if at >= end:
            raise CannotCompareError(
                f"a {what} at {at:g} s comes after the {end:g} s that are compared; give --for a later end"
            )


def _recorded(name: str, path: Path, tell: Tell, given_up: Event) -> ComparedSide:
    timeline = Timeline(until_ending=True)
    try:
        recording = read(path)
        for events in recording.batches():
            timeline.extend(events)
            tell(RunProgress(name, "reading", timeline.end))
            if given_up.is_set():
                raise GivenUpError
    except RecordingError as error:
        raise CannotCompareError(str(error)) from None
    except OSError as error:
        raise CannotCompareError(f"{path} cannot be read to its end: {error.strerror}") from None
    damage = None if recording.damage is None else f"{name}: {recording.damage}"
    return ComparedSide(name, timeline, damage=damage)


def _prepared(
    compared: ComparedRun, terms: ComparisonTerms, until: Nanoseconds, missing: Callable[[str], None]
) -> RunSetup:
    """The set-up of a run at full speed on its own clock; on virtual time if it gets recorded inputs.

    ``missing`` is called with a sentence if some inputs cannot be read.
    """
    assert isinstance(compared.what, RunRequest)
    request = replace(compared.what, seconds=until / SECOND, calls=terms.calls, lines=terms.lines)
    if terms.inputs is None:
        return request.setup()
    try:
        return repeated_setup(terms.inputs, request, tell=missing)
    except CannotRepeatError as error:
        raise CannotCompareError(str(error)) from None


def _run(
    compared: ComparedRun, terms: ComparisonTerms, until: Nanoseconds, tell: Tell, given_up: Event
) -> ComparedSide:
    name = compared.name
    damage: list[str] = []
    setup = _prepared(compared, terms, until, damage.append)
    timeline = Timeline(until_ending=True)
    with FollowedRun(setup, ProcessSession, given_up) as run:
        try:
            run.start()
            for batch in run:
                timeline.extend(batch)
                tell(RunProgress(name, "running", timeline.end, setup.until))
        except EngineLostError as error:
            raise CannotCompareError(f"{name} could not be run to its end: {error}") from None
    for notice in timeline.notices:
        if notice.kind is NoticeKind.UNMATCHED:
            raise CannotCompareError(f"{name}: {notice.text}")
    return ComparedSide(name, timeline, compared.service, damage=next(iter(damage), None))
