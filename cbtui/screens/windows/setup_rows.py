"""The rows of the set-up window: each shows a setting, asks for a new value and applies it."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Generic, Protocol

from textual.screen import ModalScreen

from cbtui.looks.theme import Charset
from cbtui.runs.setup.changeable import ChangeableArgument, ChangeableCallback, ChangeableSetup
from cbtui.runs.setup.changes import Changes
from cbtui.runs.setup.equivalent_code import (
    code_of_argument,
    code_of_period,
    code_of_release,
    code_of_sensor_rate,
)
from cbtui.runs.setup.quantities import PERIOD, SENSOR_RATE, Release, TypedValue, Value
from cbtui.screens.windows.group import UNCHANGED, GroupScreen
from cbtui.screens.windows.threads import ThreadsScreen
from cbtui.screens.windows.value import ValueScreen
from sim.quantities.nanoseconds import SECOND, nearest_ns
from sim.quantities.plural import counted


class SettingRow(Protocol):
    """One setting: ``what`` it belongs to, and its value ``now``; ``is_fixed`` if it cannot be changed."""

    @property
    def what(self) -> str:
        """The callback, or another subject."""

    @property
    def aspect(self) -> str:
        """The name of the setting."""

    @property
    def now(self) -> str:
        """The value in the run on screen, or why it cannot be changed."""

    @property
    def is_fixed(self) -> bool:
        """Whether it cannot be changed."""

    def changed_to(self, changes: Changes) -> str:
        """The changed value; "" if it is unchanged."""

    def ask(self, changes: Changes, charset: Charset) -> ModalScreen[Any]:
        """Return the window that asks for a value."""

    def take(self, changes: Changes, answer: Any) -> Changes:
        """Return the changes with that window's result."""


@dataclass(frozen=True)
class ThreadsRow:
    """How many threads the executor gets."""

    about: ChangeableSetup
    what = "executor"
    aspect = "threads"
    is_fixed = False

    @property
    def now(self) -> str:
        """The run's executor."""
        return self.about.executor_now

    def changed_to(self, changes: Changes) -> str:
        """The number that was chosen."""
        return "" if changes.threads is None else counted(changes.threads, "thread")

    def ask(self, changes: Changes, charset: Charset) -> ModalScreen[Any]:
        """Ask for a number."""
        return ThreadsScreen(self.about, changes.threads, charset)

    def take(self, changes: Changes, answer: int) -> Changes:
        """Take the number; 0 is the program's own."""
        return replace(changes, threads=answer or None)


@dataclass(frozen=True)
class GroupRow:
    """Which group a callback is in."""

    callback: ChangeableCallback
    aspect = "group"
    is_fixed = False

    @property
    def what(self) -> str:
        """The callback."""
        return self.callback.title

    @property
    def now(self) -> str:
        """Its group, and who else is in it."""
        return self.callback.group

    def changed_to(self, changes: Changes) -> str:
        """The group that was chosen."""
        return changes.group_of(self.callback.place) or ""

    def ask(self, changes: Changes, charset: Charset) -> ModalScreen[Any]:
        """Ask for a group."""
        return GroupScreen(self.callback, changes.group_of(self.callback.place), charset)

    def take(self, changes: Changes, answer: str) -> Changes:
        """Take the group."""
        return changes.with_group(self.callback.place, None if answer == UNCHANGED else answer)


@dataclass(frozen=True)
class ValueRow(Generic[Value]):
    """A value to type: ``chosen`` reads it from the changes, ``changed`` sets it, ``code`` is its line."""

    what: str
    aspect: str
    kind: TypedValue[Value]
    now: str
    chosen: Callable[[Changes], Value | None]
    changed: Callable[[Changes, Value | None], Changes]
    code: Callable[[Value], str]
    is_fixed: bool = False

    def changed_to(self, changes: Changes) -> str:
        """The value that was chosen."""
        value = self.chosen(changes)
        return "" if value is None else self.kind.shown(value)

    def ask(self, changes: Changes, charset: Charset) -> ModalScreen[Any]:
        """Ask for a value."""
        text = self.changed_to(changes) or self.now
        return ValueScreen(f"{self.what}: {self.aspect}", self.kind, text, self.code, charset)

    def take(self, changes: Changes, answer: tuple[Value | None]) -> Changes:
        """Take the value."""
        return self.changed(changes, answer[0])


def rows_of(about: ChangeableSetup) -> list[SettingRow]:
    """Return everything that can be changed."""
    rows: list[SettingRow] = [ThreadsRow(about)]
    rows += [GroupRow(callback) for callback in about.callbacks]
    rows += [_period_row(callback) for callback in about.callbacks if callback.period]
    rows += [_argument_row(argument) for argument in about.arguments]
    if about.sensor_rate is not None:
        rows.append(_sensors_row(about.sensor_rate))
    rows.append(_release_row(about.release))
    return rows


def _period_row(callback: ChangeableCallback) -> ValueRow[float]:
    place = callback.place

    def chosen(changes: Changes) -> float | None:
        period = changes.period_of(place)
        return None if period is None else period / SECOND

    def changed(changes: Changes, seconds: float | None) -> Changes:
        return changes.with_period(place, None if seconds is None else nearest_ns(seconds))

    return ValueRow(
        callback.title,
        "period",
        PERIOD,
        PERIOD.shown(callback.period / SECOND),
        chosen,
        changed,
        lambda seconds: code_of_period(callback.name, nearest_ns(seconds), callback.maker),
    )


def _argument_row(argument: ChangeableArgument) -> ValueRow[float]:
    return ValueRow(
        argument.quantity.name,
        "number",
        argument.quantity,
        argument.quantity.shown(argument.now),
        lambda changes: changes.settings.get(argument.name),
        lambda changes, number: changes.with_setting(argument.name, number),
        partial(code_of_argument, argument.name),
    )


def _sensors_row(rate: float) -> ValueRow[float]:
    return ValueRow(
        "robot's sensors",
        "rate",
        SENSOR_RATE,
        SENSOR_RATE.shown(rate),
        lambda changes: changes.sensor_rate,
        lambda changes, chosen: replace(changes, sensor_rate=chosen),
        code_of_sensor_rate,
    )


def _release_row(release: str | None) -> ValueRow[str]:
    return ValueRow(
        "rclpy",
        "release",
        Release(),
        "fixed: real ROS 2 has its own" if release is None else release,
        lambda changes: changes.distro,
        lambda changes, chosen: replace(changes, distro=chosen),
        code_of_release,
        is_fixed=release is None,
    )
