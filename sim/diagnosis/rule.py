"""What a rule is, what it finds, and how that is told."""

from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import ClassVar

import sim
from sim.diagnosis.timeline_view import TimelineView
from sim.trace.events import EntityId, ThreadId
from sim.trace.model import Entity, Nanoseconds
from sim.trace.timeline import Timeline


class Weight(Enum):
    """How much a finding matters: something goes wrong, or it is only worth knowing."""

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


@dataclass(frozen=True, slots=True)
class Finding:
    """What a rule found: one occurrence, or ``count`` of them with the times of the worst.

    ``subject`` is the callback that it happened to, ``culprit`` the one that is to blame (0: none or
    unknown); ``about`` is the topic, service or node in question. Occurrences of one rule, subject and
    ``about`` are one finding. ``size`` tells which of them is the worst, in a unit of the rule's; ``detail``
    is what the rule needs besides to explain it, and ``thread`` where it happened, if the rule asks for that.
    """

    rule: "Rule"
    at: Nanoseconds
    until: Nanoseconds
    subject: EntityId = 0
    culprit: EntityId = 0
    about: str = ""
    size: int = 0
    count: int = 1
    detail: str = ""
    thread: ThreadId = 0

    @property
    def lasted(self) -> Nanoseconds:
        """How long the worst occurrence lasted."""
        return self.until - self.at


@dataclass(frozen=True, slots=True)
class Explanation:
    """A finding in words: ``what`` happened (a line without a full stop), ``why``, and what to do.

    ``place`` is where the learner wrote what it is about; None where that is not known. ``for_ever`` tells
    that callbacks wait which can never go on.
    """

    what: str
    why: str
    cure: str
    place: CodeLocation | None
    for_ever: bool = False


class Rule(ABC):
    """One question asked of a run. Rules have no state."""

    id: ClassVar[str]
    summary: ClassVar[str]
    """What the rule looks for, in a few words."""
    weight: ClassVar[Weight] = Weight.PROBLEM

    @abstractmethod
    def check(self, look: TimelineView) -> Iterator[Finding]:
        """Yield every occurrence that lasted into the window of the look, each whole."""

    @abstractmethod
    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        """Put a finding into words."""

    def weigh(self, found: Finding, timeline: Timeline) -> Weight | None:
        """Tell how much all occurrences together matter; None if they do not."""
        return self.weight


_OURS = str(Path(sim.__file__).parent)


def place_of(entity: EntityId, timeline: Timeline) -> CodeLocation | None:
    """Where an entity's callback is written, None where the model itself wrote it, as a rate's tick."""
    known = timeline.entities.get(entity)
    if known is None or not known.file or known.file.startswith(_OURS):
        return None
    return CodeLocation(known.file, known.first_line, known.last_line)


def entity_of(found: Finding, timeline: Timeline) -> Entity:
    """The entity that a finding is about."""
    return timeline.entities[found.subject]
