"""What can be changed about a run from the keyboard: callbacks' groups and periods, and numbers."""

import linecache
import re
from collections import Counter
from dataclasses import dataclass, replace

from cbtui.runs.setup.changes import CallbackPlace
from cbtui.runs.setup.quantities import USUAL_SENSOR_RATE, Quantity
from cbtui.runs.setup.shown_program import ShownProgram
from cbtui.text.callback_names import short_name
from lessons.lesson import number_after
from sim.engine.release import profile_of
from sim.engine.setup import RobotUse, RunSetup
from sim.releases.profile import Profile
from sim.trace.descriptions import executor_label
from sim.trace.events import EntityKind
from sim.trace.model import EntityInfo, Nanoseconds
from sim.trace.roster import HOUSEKEEPING
from sim.trace.timeline import Timeline


@dataclass(frozen=True, slots=True)
class ChangeableCallback:
    """A callback with its current settings; ``group`` describes its group, ``period`` is 0 if it has no
    timer. ``maker`` is the expression for the node where its program makes it: ``self`` or ``node``;
    ``is_alone`` tells that no other node has one of its name.
    """

    place: CallbackPlace
    kind: EntityKind
    group: str
    period: Nanoseconds
    maker: str = "self"
    is_alone: bool = True

    @property
    def name(self) -> str:
        """Its name, or its service's if it has none."""
        return self.place[1]

    @property
    def title(self) -> str:
        """Its name, with its node if callbacks of other nodes have the same one."""
        return self.name if self.is_alone else f"{self.name} ({self.place[0]})"


@dataclass(frozen=True, slots=True)
class ChangeableArgument:
    """A number that a program takes as an argument, and its current value."""

    name: str
    quantity: Quantity
    now: float


@dataclass(frozen=True)
class ChangeableSetup:
    """Everything that can be changed.

    ``executor`` is the program's own, ``executor_now`` the run's. ``threads_argument`` is the argument for
    the number of threads, if the program has one. ``sensor_rate`` is in Hz, None where no robot is seen.
    ``release`` is the rclpy that the model is like, None on real ROS 2.
    """

    executor: str
    executor_now: str
    threads_argument: str | None
    callbacks: tuple[ChangeableCallback, ...]
    arguments: tuple[ChangeableArgument, ...]
    sensor_rate: float | None
    release: str | None


def changeable(subject: ShownProgram, setup: RunSetup, timeline: Timeline) -> ChangeableSetup:
    """Return what can be changed about a run, as far as its trace shows."""
    lesson, started = subject.lesson, timeline.started
    has_robot = (setup.robot is RobotUse.ALWAYS or timeline.arena is not None) and not subject.scene
    words = setup.programs[0].arguments if setup.programs else ()
    arguments = [
        ChangeableArgument(each.argument, Quantity(each.name, each.unit, each.least, each.most), number)
        for each in (() if lesson is None else lesson.settings)
        if (number := number_after(each.argument, words)) is not None
    ]
    return ChangeableSetup(
        subject.executor,
        executor_label(timeline) or subject.executor,
        None if lesson is None else lesson.setup.threads_argument,
        tuple(callbacks_of(timeline).values()),
        tuple(arguments),
        (setup.sensor_rate or USUAL_SENSOR_RATE) if has_robot else None,
        None if setup.real is not None else (started and started.distro) or str(_release_of(setup)),
    )


def _release_of(setup: RunSetup) -> Profile:
    return profile_of(setup, lambda _sentence: None)


def callbacks_of(timeline: Timeline) -> dict[CallbackPlace, ChangeableCallback]:
    """Return the callbacks of the programs' own code, in order of creation."""
    found: dict[CallbackPlace, ChangeableCallback] = {}
    for entity in timeline.entities.values():
        if programs_own(entity):
            place = place_of(entity, timeline)
            found.setdefault(
                place,
                ChangeableCallback(
                    place, entity.kind, _group_of(entity, timeline), entity.period, _maker_of(entity)
                ),
            )
    names = Counter(name for _, name in found)
    return {place: replace(each, is_alone=names[each.name] == 1) for place, each in found.items()}


def place_of(entity: EntityInfo, timeline: Timeline) -> CallbackPlace:
    """Return the names by which a change identifies an entity's callback."""
    return timeline.nodes.get(entity.node, ""), entity.callback or entity.name


def _maker_of(entity: EntityInfo) -> str:
    """Return the expression for the node in the line that makes an entity; ``self`` if none is there."""
    made = re.search(r"(\w[\w.]*)\.create_", linecache.getline(*entity.made_at))
    return made[1] if made else "self"


def is_set_bool(entity: EntityInfo) -> bool:
    """Tell whether a callback is that of a SetBool service."""
    return entity.kind is EntityKind.SERVICE and entity.interface_type == "std_srvs/srv/SetBool"


def programs_own(entity: EntityInfo) -> bool:
    """Tell whether an entity was created by the programs' own code rather than by rclpy."""
    named = bool(entity.callback or entity.name)
    return (
        named
        and entity.kind not in (EntityKind.WAITABLE, EntityKind.TASK)
        and entity.label not in HOUSEKEEPING
    )


def _group_of(entity: EntityInfo, timeline: Timeline) -> str:
    group = timeline.groups[entity.group]
    others = [
        short_name(member.spoken_name)
        for member in timeline.group_members(group.id)
        if member.id != entity.id and programs_own(member)
    ]
    company = f", with {', '.join(others)}" if others else ", alone"
    return f"{group.letter} {group.kind.value}{company}"
