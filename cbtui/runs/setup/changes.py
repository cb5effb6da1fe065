"""A person's changes to a program without editing its file, and the set-up of a run with them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TypeAlias, TypeVar

import msgspec

from cbtui.text.callback_names import short_name
from lessons.lesson import with_argument
from sim.clock.schedule import Seed
from sim.engine.setup import GroupChange, PeriodChange, PhysicsChoice, ProgramSetup, RealRos, RunSetup
from sim.quantities.nanoseconds import SECOND
from sim.quantities.plural import counted

CallbackPlace: TypeAlias = tuple[str, str]
"""A node's full name ("" for any node), and a callback's name on the trace."""

GROUP_CHOICES = ("own", "shared", "reentrant", "default")
"""The groups that a callback can be put into, as ``GroupChange`` names them."""


Key = TypeVar("Key")
Value = TypeVar("Value")


@dataclass(frozen=True)
class Changes:
    """Values that replace the program's own; None, and what is not named, keep the program's.

    ``groups`` holds values of ``GROUP_CHOICES``, ``periods`` nanoseconds, ``settings`` numbers by the name of
    their command-line argument. ``sensor_rate`` is in Hz; ``seed`` chooses the order of threads. ``real`` is
    the ROS 2 that replaces the model, always on the real clock; ``distro`` is the model's release.
    ``texts`` are run in place of what the files of programs and their modules hold, by path.
    ``whole_tracebacks`` affects only how exceptions are printed.
    """

    threads: int | None = None
    groups: Mapping[CallbackPlace, str] = field(default_factory=dict)
    periods: Mapping[CallbackPlace, int] = field(default_factory=dict)
    settings: Mapping[str, float] = field(default_factory=dict)
    sensor_rate: float | None = None
    seed: Seed | None = None
    real: RealRos | None = None
    whole_tracebacks: bool = field(default=False, compare=False)
    physics: PhysicsChoice | None = None
    distro: str | None = None
    texts: Mapping[str, str] = field(default_factory=dict)

    def with_group(self, place: CallbackPlace, wish: str | None) -> Changes:
        """Return the changes with another group for a callback."""
        return replace(self, groups=_changed(self.groups, place, wish))

    def with_period(self, place: CallbackPlace, period: int | None) -> Changes:
        """Return the changes with another period for a timer, in nanoseconds."""
        return replace(self, periods=_changed(self.periods, place, period))

    def with_setting(self, argument: str, number: float | None) -> Changes:
        """Return the changes with another number for an argument of the program."""
        left = {name: value for name, value in self.settings.items() if name != argument}
        return replace(self, settings=left if number is None else left | {argument: number})

    def group_of(self, place: CallbackPlace) -> str | None:
        """The group that was chosen for a callback of a node."""
        return _chosen(self.groups, place)

    def period_of(self, place: CallbackPlace) -> int | None:
        """The period that was chosen for a timer of a node, in nanoseconds."""
        return _chosen(self.periods, place)

    def without(self, others: Changes) -> Changes:
        """Return the changes that ``others`` do not contain."""
        return Changes(
            None if self.threads == others.threads else self.threads,
            _without(self.groups, others.groups),
            _without(self.periods, others.periods),
            _without(self.settings, others.settings),
            None if self.sensor_rate == others.sensor_rate else self.sensor_rate,
            None if self.seed == others.seed else self.seed,
            None if self.real == others.real else self.real,
            physics=None if self.physics == others.physics else self.physics,
            distro=None if self.distro == others.distro else self.distro,
            texts=_without(self.texts, others.texts),
        )

    def applied(self, setup: RunSetup) -> RunSetup:
        """The set-up with these changes applied; its own changes stay unless these replace them."""
        return msgspec.structs.replace(
            setup,
            threads=setup.threads if self.threads is None else self.threads,
            programs=tuple(self._changed(program) for program in setup.programs),
            texts={**setup.texts, **self.texts},
            sensor_rate=setup.sensor_rate if self.sensor_rate is None else self.sensor_rate,
            physics=self.physics or setup.physics,
            seed=setup.seed if self.seed is None else self.seed,
            real=setup.real if self.real is None else self.real,
            distro=setup.distro if self.distro is None else self.distro,
            clock=setup.clock if self.real is None else "real",
            whole_tracebacks=self.whole_tracebacks,
            groups=(*setup.groups, *(GroupChange(*place, wish) for place, wish in self.groups.items())),
            periods=(
                *setup.periods,
                *(PeriodChange(*place, period) for place, period in self.periods.items()),
            ),
        )

    def _changed(self, program: ProgramSetup) -> ProgramSetup:
        arguments = program.arguments
        for name, number in self.settings.items():
            arguments = tuple(with_argument(arguments, name, f"{number:g}"))
        return ProgramSetup(program.path, arguments)

    @property
    def words(self) -> str:
        """A short description such as ``odom own group, 4 threads``; "" for no change."""
        said = [f"{short_name(callback)} {wish} group" for (_, callback), wish in self.groups.items()]
        said += [
            f"{short_name(callback)} every {period / SECOND:g} s"
            for (_, callback), period in self.periods.items()
        ]
        said += [f"{argument} {number:g}" for argument, number in self.settings.items()]
        if self.sensor_rate is not None:
            said.append(f"sensors {self.sensor_rate:g} Hz")
        if self.physics is not None:
            said.append(f"{self.physics} physics")
        if self.threads is not None:
            said.append(counted(self.threads, "thread"))
        if self.distro is not None:
            said.append(self.distro)
        if self.real is not None:
            said.append("on real ROS 2")
        if self.texts:
            said.append("an edited copy")
        if self.seed is not None:
            said.append(f"seed {self.seed}")
        return ", ".join(said)


def changes_in(setup: RunSetup) -> Changes:
    """The changes in a set-up, except the numbers in the program's arguments."""
    return Changes(
        setup.threads,
        {(each.node, each.callback): each.wish for each in setup.groups},
        {(each.node, each.callback): each.period for each in setup.periods},
        sensor_rate=setup.sensor_rate,
        seed=setup.seed,
        real=setup.real,
        physics=setup.physics,
        distro=setup.distro or None,
        texts=setup.texts,
    )


def _without(ours: Mapping[Key, Value], theirs: Mapping[Key, Value]) -> dict[Key, Value]:
    return {key: value for key, value in ours.items() if theirs.get(key) != value}


def _keys(place: CallbackPlace) -> list[CallbackPlace]:
    """What may name a callback in changes, which counts most first."""
    return [(node, name) for name in (place[1], short_name(place[1])) for node in (place[0], "")]


def _chosen(all_places: Mapping[CallbackPlace, Value], place: CallbackPlace) -> Value | None:
    return next((all_places[key] for key in _keys(place) if key in all_places), None)


def _changed(
    all_places: Mapping[CallbackPlace, Value], place: CallbackPlace, value: Value | None
) -> dict[CallbackPlace, Value]:
    """A copy with another value for a place; a change for the same callback of any node is removed."""
    left = {key: kept for key, kept in all_places.items() if key not in _keys(place)}
    return left if value is None else left | {place: value}
