"""The menu's list: lessons by unit, then files that were opened before; by words, some of them only."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import groupby
from typing import TypeAlias

from textual.content import Content
from textual.widgets import OptionList
from textual.widgets.option_list import Option

from cbtui.recent import Kind, Opened, ago
from cbtui.theme import Charset
from cbtui.widgets.cells import fit, visible
from lessons.lesson import Lesson

Choice: TypeAlias = Lesson | Opened

_KINDS = {Kind.PROGRAM: "program", Kind.RECORDING: "recording"}
RECENT = "Recent"


class Choices(OptionList, inherit_bindings=False):
    """What there is to choose from; the screen's keys move its highlight."""

    def __init__(self, *, id: str | None = None) -> None:  # noqa: A002 Textual's name for it
        super().__init__(id=id, markup=False)
        self._choices: dict[str, Choice] = {}

    @property
    def chosen(self) -> Choice | None:
        """What is highlighted."""
        option = self.highlighted_option
        return None if option is None or option.id is None else self._choices[option.id]

    def choice(self, option_id: str) -> Choice:
        """Return what an option stands for."""
        return self._choices[option_id]

    def show(self, lessons: Iterable[Lesson], files: Iterable[Opened], rows: "Rows") -> None:
        """Show these; the highlight stays on what it is on, if that is still there, or goes to the first."""
        before = self.highlighted_option
        options: list[Option] = []
        self._choices = {}
        for unit, members in groupby(lessons, key=lambda lesson: lesson.unit):
            options.append(_heading(f"Unit {unit}"))
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

    def _option(self, option_id: str, choice: Choice, row: Content) -> Option:
        self._choices[option_id] = choice
        return Option(row, id=option_id)


class Rows:
    """The lines of the list where it is narrow: what they are about; the rest is told beside the list."""

    def __init__(self, opened: Mapping[str, int], now: float) -> None:
        self._opened = opened
        self._now = now

    def lesson(self, lesson: Lesson) -> Content:
        """Return a lesson's line: whether it was opened, its number, its title."""
        mark = "✓" if lesson.id in self._opened else "·"
        return Content.assemble(
            f"{mark} {lesson.number:>2}  ",
            (fit(lesson.title, 25, Charset.BRAILLE), "bold"),
        )

    def file(self, entry: Opened) -> Content:
        """Return a file's line: its name, and what it is."""
        return Content.assemble(f"  {_name(entry, 19)} ", (_KINDS[entry.kind], "$text-muted"))


class WideRows(Rows):
    """The lines where there is room to tell more."""

    def lesson(self, lesson: Lesson) -> Content:
        """Return a lesson's line with its executor and groups."""
        return Content.assemble(
            super().lesson(lesson),
            f" {fit(lesson.executor, 25, Charset.BRAILLE)} ",
            (fit(lesson.groups, 14, Charset.BRAILLE), "$text-muted"),
        )

    def file(self, entry: Opened) -> Content:
        """Return a file's line with when it was opened."""
        rest = f"{fit(_KINDS[entry.kind], 25, Charset.BRAILLE)} {ago(entry.at, self._now)}"
        return Content.assemble(f"      {_name(entry, 25)} ", (rest, "$text-muted"))


def _heading(text: str) -> Option:
    return Option(Content.styled(text, "bold $text-primary"), disabled=True)


def _name(entry: Opened, width: int) -> str:
    return fit(visible(entry.name, Charset.BRAILLE), width, Charset.BRAILLE)


def with_words(text: str) -> Callable[[Choice], bool]:
    """Return what tells whether a choice has all words of a text, in upper or lower case, whole or begun."""
    words = text.casefold().split()
    return lambda choice: all(word in _said(choice) for word in words)


def _said(choice: Choice) -> str:
    if isinstance(choice, Opened):
        parts: Sequence[str] = (choice.what, _KINDS[choice.kind], RECENT)
    else:
        unit = f"Unit {choice.unit}"
        parts = (str(choice.number), choice.title, choice.teaches, choice.executor, choice.groups, unit)
    return " ".join(parts).casefold()
