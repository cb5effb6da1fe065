"""The description of the menu's highlighted entry: a lesson, or a recent file."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from textual.geometry import Size
from textual.reactive import reactive

from cbtui.keys.keymap import STANDARD, Keymap
from cbtui.keys.named_keys import key_in_force
from cbtui.looks.theme import Charset, Ink, Role, TextRun
from cbtui.runs.setup.recent import RecentEntry, RecentKind, time_ago
from cbtui.text.cells import fit, lines_of_text
from cbtui.widgets.painted_widget import PaintedWidget, painted
from lessons.lesson import Lesson
from lessons.puzzles import Puzzle

_STRONG = Ink(Role.STRONG)
_PLAIN = Ink(Role.TEXT)
_FAINT = Ink(Role.FAINT)
_KEYS = 7
_FACTS = 10


@dataclass(frozen=True)
class EntryDescription:
    """A title, a text, facts, and keys with their meanings."""

    title: str
    text: str
    facts: tuple[tuple[str, str], ...] = ()
    keys: tuple[tuple[str, str], ...] = ()


class DescriptionPane(PaintedWidget):
    """Shows a description; keys and a blank line without room are left out, the rest is cut at the bottom."""

    description: reactive[EntryDescription | None] = painted(None)

    def rows(self, size: Size) -> Sequence[Sequence[TextRun]]:
        """Paint the description."""
        if self.description is None or not size.width:
            return []
        return described(self.description, size)[: size.height]


def of_lesson(
    lesson: Lesson, text: str, opened: int | None, now: float, progress: str = "", keymap: Keymap = STANDARD
) -> EntryDescription:
    """Describe a lesson that was opened at a moment, None for never; times are seconds since 1970.

    ``text`` describes the lesson, ``progress`` the learner's progress in it.
    """
    facts = (
        *((("so far", progress),) if progress else ()),
        ("executor", lesson.executor),
        ("groups", lesson.groups),
        ("service", lesson.service.name),
        *((("clock", "real: computing takes time"),) if lesson.setup.clock == "real" else ()),
        *(() if opened is None else (("opened", time_ago(opened, now)),)),
    )
    keys = tuple((key_in_force(attempt.key, keymap), attempt.text) for attempt in lesson.tries)
    return EntryDescription(lesson.title, text, facts, keys)


_PUZZLE = (
    "A puzzle: you are the scheduler. Wherever more than one thread can go on, time stands still, "
    "and you choose."
)


def of_puzzle(puzzle: Puzzle, lesson: str, progress: str) -> EntryDescription:
    """Describe a puzzle; ``lesson`` is the title of its lesson, ``progress`` the learner's progress in it."""
    facts = (("lesson", lesson), *((("so far", progress),) if progress else ()))
    return EntryDescription(puzzle.title, f"{puzzle.task} {_PUZZLE}", facts)


_WHAT = {
    RecentKind.PROGRAM: "Your own program: opening it runs it again, on the {clock} clock.",
    RecentKind.RECORDING: "A recording: opening it shows it, and runs nothing.",
}


def of_file(entry: RecentEntry, now: float, forget_key: str) -> EntryDescription:
    """Describe a program or a recording at a moment, in seconds since 1970.

    ``forget_key`` is the key that removes a missing file from the list.
    """
    path = Path(entry.what)
    facts = [("folder", str(path.parent)), ("opened", time_ago(entry.at, now))]
    if entry.arguments:
        facts.append(("arguments", " ".join(entry.arguments)))
    if not path.is_file():
        gone = f"The file {entry.name} is gone."
        return EntryDescription(entry.name, gone, tuple(facts), ((forget_key, "Remove it from this list."),))
    return EntryDescription(entry.name, _WHAT[entry.kind].format(clock=entry.clock), tuple(facts))


def described(about: EntryDescription, size: Size) -> list[list[TextRun]]:
    """Return the lines of a description, each ``size.width`` columns wide; there may be too many."""
    width = size.width
    rows = [[_line(about.title, width, _STRONG)]]
    rows += [[_line(text, width, _PLAIN)] for text in lines_of_text(about.text, width)]
    facts = [line for name, fact in about.facts for line in _entry(name, fact, width, _FACTS, _FAINT)]
    if len(rows) + len(facts) < size.height:
        rows.append([_line("", width, _PLAIN)])
    rows += facts
    between = [[_line("", width, _PLAIN)]]
    for key, text in about.keys:
        lines = [*between, *_entry(key, text, width, _KEYS, _STRONG)]
        if len(rows) + len(lines) > size.height:
            break
        rows += lines
        between = []
    return rows


def _entry(name: str, text: str, width: int, indent: int, ink: Ink) -> Iterator[list[TextRun]]:
    """Yield lines with a word at the left and a wrapped text beside it."""
    for number, line in enumerate(lines_of_text(text, max(10, width - indent))):
        left = TextRun(fit("" if number else name, indent, Charset.BRAILLE), ink)
        yield [left, _line(line, width - indent, _PLAIN)]


def _line(text: str, width: int, ink: Ink) -> TextRun:
    return TextRun(fit(text, width, Charset.BRAILLE), ink)
