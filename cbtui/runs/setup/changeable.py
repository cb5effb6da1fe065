"""What of a run can be changed from the keyboard: its callbacks' groups and periods, and its numbers."""

from dataclasses import dataclass

from cbtui.runs.setup.changes import Place, short
from cbtui.runs.setup.quantities import USUAL_SENSOR_RATE, Quantity
from cbtui.runs.setup.subject import Subject
from lessons.lesson import number_after
from sim.engine.setup import RobotUse, RunSetup
from sim.trace.descriptions import executor_label
from sim.trace.events import EntityKind
from sim.trace.model import Entity, Nanoseconds
from sim.trace.roster import HOUSEKEEPING
from sim.trace.timeline import Timeline


@dataclass(frozen=True, slots=True)
class Callback:
    """A callback as the run has it; ``group`` tells of its group in words, ``period`` is 0 for no timer."""

    place: Place
    kind: EntityKind
    group: str
    period: Nanoseconds

    @property
    def name(self) -> str:
        """Its name, or its service's where it has none."""
        return self.place[1]


@dataclass(frozen=True, slots=True)
class Argument:
    """A number that an argument of the program carries, and what it is now."""

    name: str
    quantity: Quantity
    now: float


@dataclass(frozen=True)
class Changeable:
    """All of it.

    ``executor`` is the program's own, ``executor_now`` the run's; ``threads_argument`` carries the number of
    threads where the program takes one. ``sensor_rate`` is in Hz, None where there is no robot.
    """

    executor: str
    executor_now: str
    threads_argument: str | None
    callbacks: tuple[Callback, ...]
    arguments: tuple[Argument, ...]
    sensor_rate: float | None


def changeable(subject: Subject, setup: RunSetup, timeline: Timeline) -> Changeable:
    """Return what can be changed about a subject's run, as far as it shows."""
    lesson = subject.lesson
    words = setup.programs[0].arguments if setup.programs else ()
    arguments = [
        Argument(each.argument, Quantity(each.name, each.unit, each.least, each.most), number)
        for each in (() if lesson is None else lesson.settings)
        if (number := number_after(each.argument, words)) is not None
    ]
    return Changeable(
        subject.executor,
        executor_label(timeline) or subject.executor,
        None if lesson is None else lesson.setup.threads_argument,
        tuple(callbacks_of(timeline).values()),
        tuple(arguments),
        None if setup.robot is RobotUse.NEVER else setup.sensor_rate or USUAL_SENSOR_RATE,
    )


def callbacks_of(timeline: Timeline) -> dict[Place, Callback]:
    """Return the callbacks of the programs' own, in the order in which they were made."""
    found: dict[Place, Callback] = {}
    for entity in timeline.entities.values():
        if _is_programs_own(entity):
            place = place_of(entity, timeline)
            found.setdefault(place, Callback(place, entity.kind, _group_of(entity, timeline), entity.period))
    return found


def place_of(entity: Entity, timeline: Timeline) -> Place:
    """Return the names by which a change names an entity's callback."""
    return timeline.nodes.get(entity.node, ""), entity.callback or entity.name


def _is_programs_own(entity: Entity) -> bool:
    named = bool(entity.callback or entity.name)
    return named and entity.kind is not EntityKind.WAITABLE and entity.label not in HOUSEKEEPING


def _group_of(entity: Entity, timeline: Timeline) -> str:
    group = timeline.groups[entity.group]
    others = [
        short(member.spoken_name)
        for member in timeline.group_members(group.id)
        if member.id != entity.id and _is_programs_own(member)
    ]
    company = f", with {', '.join(others)}" if others else ", alone"
    return f"{group.letter} {group.kind.value}{company}"
