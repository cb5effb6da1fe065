"""The interface of a rule, its findings and their explanations."""

from abc import ABC, abstractmethod
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from enum import Enum, StrEnum
from pathlib import Path
from traceback import extract_tb
from typing import ClassVar
from warnings import warn

import sim
from sim.diagnosis.cures import Remedy
from sim.diagnosis.edits.code_edit import CodeEdit
from sim.diagnosis.timeline_view import TimelineView
from sim.diagnosis.words import SPIN_ALWAYS, SPIN_BESIDE
from sim.trace.events import AnyEvent, EntityId, ThreadId
from sim.trace.model import EntityInfo, Nanoseconds, Position, Window
from sim.trace.timeline import Timeline


class Weight(Enum):
    """How much a finding matters: something goes wrong, or it is merely worth knowing."""

    PROBLEM = "problem"
    REMARK = "remark"


@dataclass(frozen=True, slots=True)
class CodeLocation:
    """Lines of the learner's code."""

    file: str
    first_line: int
    last_line: int

    def __str__(self) -> str:
        return f"{Path(self.file).name}:{self.first_line}"


class WaitedFor(StrEnum):
    """What a callback may wait for without end."""

    REPLY = "a reply"
    RATE = "the rate's timer"
    CLOCK = "the simulated time"
    LOCK = "a lock"
    THREAD = "the end of a thread"
    JOB = "the result of a job"
    FUTURE = "a future"


REPORT_IT = "please report this fault of cbtui, with the recording if you may; what else is told holds"
"""What to do about a rule that fails."""


class RuleFault(ResourceWarning):
    """A rule failed on a run: a finding says so; Python's warning of it is shown with ``-X dev``."""


def fault_of(rule: "Rule", error: Exception) -> str:
    """Return what a rule failed with and at which line, and warn of it."""
    frame = extract_tb(error.__traceback__)[-1]
    fault = f"{type(error).__name__}: {error} ({Path(frame.filename).name}:{frame.lineno})"
    warn(f"{rule.id}: {fault}", RuleFault, stacklevel=2)
    return fault


@dataclass(frozen=True, slots=True)
class Finding:
    """What a rule found: one occurrence, or ``count`` of them with the times of the worst.

    ``subject`` is the affected callback, ``culprit`` the one to blame (0: none or unknown); ``about`` is the
    topic, service or node in question. Of occurrences with the same ``key`` the worst subject's are found.
    ``size`` ranks them, the worst highest, in a unit of the rule; ``detail``, ``thread`` and ``event``, the
    event that shows it, are what the rule needs to explain it.
    """

    rule: "Rule"
    at: Nanoseconds
    until: Nanoseconds
    subject: EntityId = 0
    culprit: EntityId = 0
    about: str = ""
    due_to: EntityId = 0
    """The callback whose own finding this one is part of; 0 for none."""
    size: int = 0
    count: int = 1
    detail: str = ""
    thread: ThreadId = 0
    event: AnyEvent | None = None
    stuck: frozenset[EntityId] = frozenset()
    """The callbacks that can never continue, or not before ``ends``."""
    ends: Nanoseconds = 0
    """When a timeout ends their wait; 0 if nothing does."""
    waited_for: frozenset[WaitedFor] = frozenset()
    """What those callbacks wait for that wait for each other."""
    ring: tuple[str, ...] = ()
    """The cycle of waits, from a callback by the awaited things back to it: ``tick``, ``/add``, ``tick``."""
    keeper: EntityId = 0
    """The callback of a cycle that keeps its group from what others wait for; 0 for none."""
    closed: Nanoseconds = 0
    """When the last of the waits of a cycle began; 0 for none."""

    @property
    def key(self) -> tuple[str, EntityId, str]:
        """What occurrences of one finding have in common."""
        return self.rule.id, self.culprit if self.rule.by_culprit else self.subject, self.about

    @property
    def known_at(self) -> Nanoseconds:
        """When all held that it says, but for how long it lasts."""
        return max(self.at, self.closed)

    @property
    def lasted(self) -> Nanoseconds:
        """How long the worst occurrence lasted."""
        return self.until - self.at

    def relevance(self, timeline: Timeline) -> Weight | None:
        """Return the weight that the rule gives it, its usual one if it fails; None if it is irrelevant."""
        try:
            return self.rule.weigh(self, timeline)
        except Exception as error:  # noqa: BLE001 - a fault of one rule, told with the finding
            fault_of(self.rule, error)
            return self.rule.weight

    def weight_in(self, timeline: Timeline) -> Weight:
        """Return how much it matters, as much as others of its rule if it is irrelevant."""
        return self.relevance(timeline) or self.rule.weight

    def explained(self, timeline: Timeline) -> "Explanation":
        """Return it in the rule's words; if the rule fails, what it looks for and what it failed with."""
        try:
            return self.rule.explain(self, timeline)
        except Exception as error:  # noqa: BLE001 - a fault of one rule, told with the finding
            why = f"the words for it could not be made: {fault_of(self.rule, error)}"
            return Explanation(self.rule.summary, why, REPORT_IT, place_of(self.subject, timeline))


@dataclass(frozen=True, slots=True)
class Explanation:
    """A finding in words: ``what`` happened (a line without a full stop), ``why``, and what to do.

    ``place`` is the learner's code in question; None if it is unknown. ``for_ever``: whether callbacks can
    never continue; ``until`` is when the timeout is over of callbacks that can continue no earlier, 0 for
    none. ``remedies`` are the parts of the cure that can be tried, each by itself.
    """

    what: str
    why: str
    cure: str
    place: CodeLocation | None
    for_ever: bool = False
    until: Nanoseconds = 0
    remedies: tuple[Remedy, ...] = ()


class Rule(ABC):
    """One question asked of a run. Rules have no state."""

    id: ClassVar[str]
    summary: ClassVar[str]
    """What the rule looks for, in a few words."""
    weight: ClassVar[Weight] = Weight.PROBLEM
    by_culprit: ClassVar[bool] = False
    """Whether all effects of one culprit on others are one finding."""
    is_effect: ClassVar[bool] = False
    """Whether the rule finds effects of a callback that can never continue."""
    dated_by_first: ClassVar[bool] = False
    """Whether ``at`` is when the first occurrence began; ``until`` is the worst one's end all the same."""
    known_from_start: ClassVar[bool] = False
    """Whether all that a finding says held at its ``at``, as one event has it."""
    hides: ClassVar[frozenset[str]] = frozenset()
    """The rules that are not told beside a finding, of its culprit if both have one: their advice would not
    help while it stands, or says the same."""
    hangs_from: ClassVar[Nanoseconds | None] = None
    """How long what is found has lasted once it counts as a callback that hangs; None if it never does."""

    @abstractmethod
    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield every occurrence that reaches into the view's window, uncut."""

    def kind(self, found: Finding, timeline: Timeline) -> str:
        """Return the kind of problem, by which lessons say that they show it."""
        return self.id

    @abstractmethod
    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        """Put a finding into words."""

    def weigh(self, found: Finding, timeline: Timeline) -> Weight | None:
        """Return the weight of all occurrences together; None if they are irrelevant."""
        return self.weight


_MODEL_FOLDER = str(Path(sim.__file__).parent)
_RCLPYS = ("/rclpy/timer.py", "/rclpy/time_source.py")


def is_models(entity: EntityInfo) -> bool:
    """Return whether an entity belongs to the model or to rclpy, such as the timer of a rate."""
    return entity.file.startswith(_MODEL_FOLDER) or entity.file.endswith(_RCLPYS)


def made_in(entities: Iterable[EntityInfo]) -> dict[str, set[int]]:
    """Return the lines at which a program made entities, by file."""
    made: defaultdict[str, set[int]] = defaultdict(set)
    for file, line in (each.made_at for each in entities if not is_models(each)):
        made[file].add(line)
    return made


def place_of(entity: EntityId, timeline: Timeline) -> CodeLocation | None:
    """Return the code of an entity's callback; None if the entity belongs to the model."""
    known = timeline.entities.get(entity)
    if known is None or not known.file or is_models(known):
        return None
    return CodeLocation(known.file, known.first_line, known.last_line)


def line_location(file: str, line: int) -> CodeLocation | None:
    """Return one line of the learner's code; None for line 0, an unknown line."""
    return CodeLocation(file, line, line) if line else None


def made_at(entity: EntityInfo) -> CodeLocation | None:
    """Return the program's own line that made an entity; None if it is unknown."""
    return line_location(*entity.made_at)


def loop_beside_spin(at: Nanoseconds, timeline: Timeline) -> tuple[CodeLocation | None, str]:
    """Return the program's own loop in which it is at ``at`` while nothing spins, and the cure.

    The place is the line of a rate's ``sleep()``, with which no loop goes on; None if it is in no loop.
    """
    program = timeline.program_at(at)
    if program is None:
        return None, ""
    if program.call == "Rate.sleep":
        file, _, line = program.frames[-1]
        return line_location(file, line), SPIN_BESIDE
    return line_location(*program.loop), SPIN_ALWAYS


def line_of(entity: EntityId, window: Window, timeline: Timeline) -> CodeLocation | None:
    """Return the line at which a callback was longest in a window; all of its lines if that is unknown.

    That is a line of its own, or of a function that it calls if most of the time there went by at one line.
    Of lines that took about as long it is the first, so that chance does not decide. Where calls run at once
    on several threads, the longest counts.
    """
    on_threads: defaultdict[ThreadId, Counter[tuple[tuple[str, int], ...]]] = defaultdict(Counter)
    for each in positions_of_call(entity, window, timeline):
        end = each.end_at(timeline.end)
        path = tuple((frame.file, frame.line) for frame in each.frames)
        on_threads[each.thread][path] += min(end, window.end) - max(each.start, window.start) + 1
    lasted = max(on_threads.values(), key=Counter.total, default=Counter())
    found: tuple[str, int] | None = None
    while lasted:
        lines: Counter[tuple[str, int]] = Counter()
        for path, length in lasted.items():
            lines.update({path[0]: length} if path else {})
        longest = max(lines.values(), default=0)
        if found is not None and 2 * longest <= lasted.total():
            break
        found = min(line for line, length in lines.items() if length >= _ABOUT * longest)
        lasted = Counter({path[1:]: length for path, length in lasted.items() if path[:1] == (found,)})
    return place_of(entity, timeline) if found is None else CodeLocation(*found, found[1])


def positions_of_call(entity: EntityId, during: Window, timeline: Timeline) -> Sequence[Position]:
    """Return where the call was that began with a time and lasted for all of it, else where all were."""
    known = timeline.positions_of(entity, during)
    calls = timeline.spans_of(entity, Window(during.start, during.start + 1))
    ran = (call for call in calls if call.start == during.start and call.end_at(during.end) >= during.end)
    threads = [call.thread for call in ran]
    return [each for each in known if each.thread in threads] if threads else known


_ABOUT = 0.75
"""The share of the longest time at a line that counts as equally long."""


def by_edit(
    place: CodeLocation | None, words: str, change: Callable[..., None], *more: object, again: bool = False
) -> tuple[Remedy, ...]:
    """Return the remedy that edits a place by a function of its line and ``more``; none without a place."""
    if place is None:
        return ()
    edit = CodeEdit(place.file, words, change, (place.first_line, *more))
    return (Remedy(edit=edit, again=again),)


def entity_of(found: Finding, timeline: Timeline) -> EntityInfo:
    """Return the affected entity of a finding."""
    return timeline.entities[found.subject]
