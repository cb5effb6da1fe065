"""The menu's list: lessons by unit, then recent files; a search filters it."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import groupby
from typing import TypeAlias

from textual.content import Content
from textual.widgets import OptionList
from textual.widgets.option_list import Option

from cbtui.learning.stage import Stage
from cbtui.looks.theme import Charset
from cbtui.runs.setup.recent import RecentEntry, RecentKind, time_ago
from cbtui.text.cells import fit, visible
from lessons.lesson import Lesson

MenuChoice: TypeAlias = Lesson | RecentEntry

_KINDS = {RecentKind.PROGRAM: "program", RecentKind.RECORDING: "recording"}
RECENT = "Recent"

_TITLE, _EXECUTOR, _GROUPS = 24, 17, 24
"""Columns of a lesson's description; with mark and number they fill the wide list."""


class MenuList(OptionList, inherit_bindings=False):
    """The list of lessons and files; its highlight is moved by the screen's keys."""

    def __init__(self, *, id: str | None = None) -> None:  # noqa: A002 Textual's name for it
        super().__init__(id=id, markup=False)
        self._choices: dict[str, MenuChoice] = {}

    @property
    def chosen(self) -> MenuChoice | None:
        """What is highlighted."""
        option = self.highlighted_option
        return None if option is None or option.id is None else self._choices[option.id]

    def choice(self, option_id: str) -> MenuChoice:
        """Return the lesson or file of an option."""
        return self._choices[option_id]

    def show(self, lessons: Iterable[Lesson], files: Iterable[RecentEntry], rows: "MenuRows") -> None:
        """Show entries; the highlight stays on its entry, or goes to the first if that is gone."""
        before = self.highlighted_option
        options: list[Option] = []
        self._choices = {}
        for unit, members in groupby(lessons, key=lambda lesson: lesson.unit):
            options.append(_heading(f"Unit {unit}{rows.total(unit)}"))
            options += [self._option(lesson.id, lesson, rows.lesson(lesson)) for lesson in members]
        listed = [self._option(":".join(entry.key), entry, rows.file(entry)) for entry in files]
        options += [_heading(RECENT), *listed] if listed else []
        self.set_options(options)
        if before is not None and before.id in self._choices:
            self.choose(str(before.id))
        else:
            self.highlight_first()

    def choose(self, option_id: str) -> None:
        """Highlight something, if it is shown."""
        if option_id in self._choices:
            self.highlighted = self.get_option_index(option_id)

    def highlight_first(self) -> None:
        """Highlight the first choice."""
        first = next(iter(self._choices), None)
        self.highlighted = None if first is None else self.get_option_index(first)

    def _option(self, option_id: str, choice: MenuChoice, row: Content) -> Option:
        self._choices[option_id] = choice
        return Option(row, id=option_id)


class MenuRows:
    """The lines of the narrow list: names only, as the details are shown beside it."""

    def __init__(self, lessons: Sequence[Lesson], stages: Mapping[str, Stage], now: float) -> None:
        """Take all lessons, how far the learner is in each by its id, and seconds since 1970."""
        self._lessons = lessons
        self._stages = stages
        self._now = now

    def total(self, unit: str) -> str:
        """Return how many lessons of a unit are done."""
        stages = [self._stages[lesson.id] for lesson in self._lessons if lesson.unit == unit]
        return f" {stages.count(Stage.DONE)}/{len(stages)}"

    def lesson(self, lesson: Lesson) -> Content:
        """Return a lesson's line: how far the learner is in it, its number, its title."""
        return Content.assemble(
            f"{self._stages[lesson.id].value} {lesson.number:>2}  ",
            (fit(lesson.title, _TITLE, Charset.BRAILLE), "bold"),
        )

    def file(self, entry: RecentEntry) -> Content:
        """Return a file's line: its name, and what it is."""
        return Content.assemble(f"  {_name(entry, 19)} ", (_KINDS[entry.kind], "$text-muted"))


class WideMenuRows(MenuRows):
    """The lines of the wide list, with details."""

    def lesson(self, lesson: Lesson) -> Content:
        """Return a lesson's line with its executor and groups."""
        return Content.assemble(
            super().lesson(lesson),
            f" {fit(_briefly(lesson.executor), _EXECUTOR, Charset.BRAILLE)} ",
            (fit(lesson.groups, _GROUPS, Charset.BRAILLE), "$text-muted"),
        )

    def file(self, entry: RecentEntry) -> Content:
        """Return a file's line with when it was opened."""
        rest = f"{fit(_KINDS[entry.kind], _EXECUTOR, Charset.BRAILLE)} {time_ago(entry.at, self._now)}"
        return Content.assemble(f"      {_name(entry, _TITLE)} ", (rest, "$text-muted"))


def _briefly(executor: str) -> str:
    """An executor's name without the ending that all of them share."""
    return executor.replace("ThreadedExecutor", "Threaded")


def _heading(text: str) -> Option:
    return Option(Content.styled(text, "bold $text-primary"), disabled=True)


def _name(entry: RecentEntry, width: int) -> str:
    return fit(visible(entry.name, Charset.BRAILLE), width, Charset.BRAILLE)


def with_words(text: str) -> Callable[[MenuChoice], bool]:
    """Return a predicate: whether an entry contains all words of a text, ignoring case."""
    words = text.casefold().split()
    return lambda choice: all(word in _said(choice) for word in words)


def _said(choice: MenuChoice) -> str:
    if isinstance(choice, RecentEntry):
        parts: Sequence[str] = (choice.what, _KINDS[choice.kind], RECENT)
    else:
        unit = f"Unit {choice.unit}"
        parts = (str(choice.number), choice.title, choice.teaches, choice.executor, choice.groups, unit)
    return " ".join(parts).casefold()
