"""What a lesson is about: what it teaches, what it is made of, what there is to try."""

from collections.abc import Iterator, Sequence
from textwrap import wrap

from textual.geometry import Size
from textual.reactive import reactive

from cbtui.theme import Charset, Ink, Role, Run
from cbtui.widgets.cells import fit, visible
from cbtui.widgets.painted import Painted
from lessons.lesson import Lesson

_STRONG = Ink(Role.STRONG)
_PLAIN = Ink(Role.TEXT)
_FAINT = Ink(Role.FAINT)
_KEYS = 7
_FACTS = 10


class About(Painted):
    """Describes a lesson; what there is not room for is cut off at the bottom."""

    lesson: reactive[Lesson | None] = reactive(None)

    def rows(self, size: Size) -> Sequence[Sequence[Run]]:
        """Paint the description; a low widget leaves out what the list says already."""
        if self.lesson is None or not size.width:
            return []
        facts = _facts(self.lesson) if size.height >= _FACTS + 2 else ()
        return list(described(self.lesson, facts, size.width))[: size.height]

    def watch_lesson(self) -> None:
        """Describe another lesson."""
        self.changed()


def described(lesson: Lesson, facts: Sequence[tuple[str, str]], width: int) -> Iterator[list[Run]]:
    """Yield the lines of a description, each ``width`` columns wide."""
    yield [_line(lesson.title, width, _STRONG)]
    for text in wrap(visible(lesson.teaches, Charset.BRAILLE), width):
        yield [_line(text, width, _PLAIN)]
    yield [_line("", width, _PLAIN)]
    for name, fact in facts:
        yield from _entry(name, fact, width, _FACTS, _FAINT)
    if facts:
        yield [_line("", width, _PLAIN)]
    for attempt in lesson.tries:
        yield from _entry(attempt.key, attempt.text, width, _KEYS, _STRONG)


def _facts(lesson: Lesson) -> tuple[tuple[str, str], ...]:
    return (
        ("executor", lesson.executor),
        ("groups", lesson.groups),
        ("service", f"{lesson.service.name} ({lesson.service.type})"),
    )


def _entry(name: str, text: str, width: int, indent: int, ink: Ink) -> Iterator[list[Run]]:
    """Yield a word at the left and text beside it, wrapped."""
    for number, line in enumerate(wrap(visible(text, Charset.BRAILLE), max(10, width - indent))):
        left = Run(fit("" if number else name, indent, Charset.BRAILLE), ink)
        yield [left, _line(line, width - indent, _PLAIN)]


def _line(text: str, width: int, ink: Ink) -> Run:
    return Run(fit(text, width, Charset.BRAILLE), ink)
