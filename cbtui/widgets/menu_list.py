"""The menu's list: lessons by unit, then recent files; a search filters it."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from itertools import groupby
from operator import itemgetter
from typing import ClassVar, TypeAlias

from textual.binding import BindingType
from textual.content import Content
from textual.geometry import Offset
from textual.widgets.option_list import Option

from cbtui.learning.stage import Stage, next_lesson
from cbtui.looks.theme import Charset
from cbtui.runs.setup.recent import RecentEntry, RecentKind, time_ago
from cbtui.terminal.textual_internals import first_lines
from cbtui.text.cells import fit, visible
from cbtui.widgets.jump import JumpTarget
from cbtui.widgets.pageable_option_list import PageableOptionList
from lessons.lesson import Lesson
from lessons.puzzles import Puzzle

MenuChoice: TypeAlias = Lesson | RecentEntry | Puzzle
Taught: TypeAlias = tuple[str, Lesson | Puzzle]
"""A lesson or a puzzle with its unit."""

_KINDS = {RecentKind.PROGRAM: "program", RecentKind.RECORDING: "recording"}
RECENT = "Recent"

_TITLE, _EXECUTOR, _GROUPS = 24, 17, 24
"""Columns of a lesson's details; with sign and number they fill the wide list."""
_OVERHANG = 3
"""Columns of the narrow list after a title."""


class MenuList(PageableOptionList, inherit_bindings=False):
    """The list of lessons and files; the screen's keys move its highlight, but for those of far moves."""

    BINDINGS: ClassVar[list[BindingType]] = [
        ("home", "first"),
        ("end", "last"),
        ("pageup", "page_up"),
        ("pagedown", "page_down"),
    ]

    def __init__(self, *, id: str | None = None) -> None:  # noqa: A002 Textual's name for it
        super().__init__(id=id, markup=False)
        self._choices: dict[str, MenuChoice] = {}

    @property
    def chosen(self) -> MenuChoice | None:
        """The highlighted entry."""
        option = self.highlighted_option
        return None if option is None or option.id is None else self._choices[option.id]

    def choice(self, option_id: str) -> MenuChoice:
        """Return the lesson or file of an option."""
        return self._choices[option_id]

    def show(self, lessons: Iterable[Taught], files: Iterable[RecentEntry], rows: "MenuRows") -> None:
        """Show entries; the highlight stays on its entry, or goes to the next lesson, or the first entry."""
        before = self.highlighted_option
        options: list[Option] = []
        self._choices = {}
        for unit, members in groupby(lessons, key=itemgetter(0)):
            options.append(_heading(f"Unit {unit}{rows.total(unit)}"))
            options += [self._option(each.id, each, rows.row(each)) for _, each in members]
        listed = [self._option(id_of(entry), entry, rows.file(entry)) for entry in files]
        options += [_heading(RECENT), *listed] if listed else []
        self.set_options(options)
        if before is not None and before.id in self._choices:
            self.choose(str(before.id))
        else:
            self.highlight_first()
            self.choose(rows.next_id)

    def choose(self, option_id: str) -> None:
        """Highlight an entry, if it is shown."""
        if option_id in self._choices:
            self.highlighted = self.get_option_index(option_id)

    def highlight_first(self, text: str = "") -> None:
        """Highlight the first choice whose title has all words of a text, or else the first one."""
        titled = (each for each, choice in self._choices.items() if _is_titled(choice, text))
        first = next(titled, next(iter(self._choices), None))
        self.highlighted = None if first is None else self.get_option_index(first)

    def jump_targets(self) -> Iterator[JumpTarget]:
        """Yield the entries in view; the letter takes the place of the sign before the number."""
        for row, index in first_lines(self):
            entry = self.get_option_at_index(index).id
            if entry is not None:
                yield JumpTarget(Offset(-1, row), partial(self.choose, entry))

    def _option(self, option_id: str, choice: MenuChoice, row: Content) -> Option:
        self._choices[option_id] = choice
        return Option(row, id=option_id)


class MenuRows:
    """The lines of the narrow list: names only, as details are shown beside it."""

    WIDTH = _TITLE + _OVERHANG
    """Columns for a title, and an invitation to open it."""
    AFTER = ""
    """Blanks that keep an invitation apart from the next column."""

    def __init__(self, lessons: Sequence[Lesson], stages: Mapping[str, Stage], now: float) -> None:
        """Take all lessons, the learner's stage in each by its id, and the time in seconds since 1970."""
        self._lessons = lessons
        self._stages = stages
        self._now = now
        self._next = next_lesson(lessons, stages)
        begun = any(stage is not Stage.UNTOUCHED for stage in stages.values())
        self.next_id = "" if self._next is None else self._next.id
        """The id of the lesson to go on with; "" for none."""
        self._invitations = ("◂ go on here", "◂ go on") if begun else ("◂ start here", "◂ start")

    def total(self, unit: str) -> str:
        """Return the number of done lessons of a unit, as text."""
        stages = [self._stages[lesson.id] for lesson in self._lessons if lesson.unit == unit]
        return f" {stages.count(Stage.DONE)}/{len(stages)}"

    def row(self, choice: Lesson | Puzzle) -> Content:
        """Return the line of a lesson, or of a puzzle below its own."""
        if isinstance(choice, Lesson):
            return self.lesson(choice)
        return Content(f"{self._stages[choice.id].value}     ? {choice.title}")

    def lesson(self, lesson: Lesson) -> Content:
        """Return a lesson's line: the sign of its stage, its number, its title."""
        title = fit(lesson.title, min(len(lesson.title), _TITLE), Charset.BRAILLE)
        room = self.WIDTH - len(title) - 1
        signs = (f"{sign}{self.AFTER}" for sign in (*self._invitations, "◂"))
        invitations = (*signs, "") if lesson is self._next else ("",)
        invitation = next(text for text in invitations if len(text) <= max(0, room))
        return Content.assemble(
            f"{self._stages[lesson.id].value} {lesson.number:>2}  ",
            (fit(title, self.WIDTH - len(invitation), Charset.BRAILLE), "bold"),
            (invitation, "bold $text-accent"),
        )

    def file(self, entry: RecentEntry) -> Content:
        """Return a file's line: its name and its kind."""
        return Content.assemble(f"  {_name(entry, 19)} ", (_KINDS[entry.kind], "$text-muted"))


class WideMenuRows(MenuRows):
    """The lines of the wide list, with details."""

    WIDTH = _TITLE
    AFTER = "  "

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
    """An executor's name without the ending that all share."""
    return executor.replace("ThreadedExecutor", "Threaded")


def _heading(text: str) -> Option:
    return Option(Content.styled(text, "bold $text-primary"), disabled=True)


def _name(entry: RecentEntry, width: int) -> str:
    return fit(visible(entry.name, Charset.BRAILLE), width, Charset.BRAILLE)


def with_words(text: str) -> Callable[[MenuChoice], bool]:
    """Return a predicate: whether an entry contains all words of a text, ignoring case.

    A number alone is that of a lesson, or its first digit.
    """
    words = text.casefold().split()
    if text.isdecimal():
        return lambda choice: isinstance(choice, Lesson) and str(choice.number).startswith(text)
    return lambda choice: all(word in _said(choice) for word in words)


def found_in(taught: Sequence[Taught], text: str) -> list[Taught]:
    """Return the lessons and puzzles that a text finds, in their order.

    If there are some whose titles have all of its words, the others need the text as it was typed.
    """
    found = [each for each in taught if with_words(text)(each[1])]
    phrase = text.casefold().strip()
    titled = [each for each in found if _is_titled(each[1], text)]
    return [each for each in found if not titled or each in titled or phrase in _said(each[1])]


def _is_titled(choice: MenuChoice, text: str) -> bool:
    """Whether the title of a lesson or puzzle has all words of a text, which is no number."""
    if isinstance(choice, RecentEntry) or text.isdecimal():
        return False
    return all(word in choice.title.casefold() for word in text.casefold().split())


def _said(choice: MenuChoice) -> str:
    if isinstance(choice, RecentEntry):
        parts: Sequence[str] = (choice.what, _KINDS[choice.kind], RECENT)
    elif isinstance(choice, Puzzle):
        parts = (choice.title, choice.task, "puzzle")
    else:
        unit, told = f"Unit {choice.unit}", (choice.title, choice.teaches, choice.executor, choice.groups)
        parts = (str(choice.number), *told, unit, *choice.diagnoses.node, *choice.diagnoses.shows)
    return " ".join(parts).casefold()


def id_of(entry: RecentEntry) -> str:
    """Return the id of an entry's row."""
    return entry.what if entry.kind is RecentKind.LESSON else ":".join(entry.key)
