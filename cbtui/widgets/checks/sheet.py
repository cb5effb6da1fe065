"""What the checks of an exercise come to, and that as lines of words with a kind each."""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum, StrEnum
from textwrap import wrap
from typing import NamedTuple

from cbtui.looks.theme import Charset
from cbtui.runs.judged.check_text import FAILED, PASSED
from cbtui.text.cells import visible
from sim.trace.model import Nanoseconds

_INDENT = 2
_LEAST_WIDTH = 20


class Kind(StrEnum):
    """What a piece of text is; the value is its component class."""

    PASSED = "checks--passed"
    FAILED = "checks--failed"
    OPEN = "checks--open"
    ASKS = "checks--asks"
    DETAIL = "checks--detail"
    TITLE = "checks--title"
    TEXT = "checks--text"


class Standing(Enum):
    """How a check, or all of an exercise, stands: a sign and how that looks."""

    PASSED = (PASSED, Kind.PASSED)
    FAILED = (FAILED, Kind.FAILED)
    OPEN = ("·", Kind.OPEN)
    WRONG = ("!", Kind.FAILED)

    @property
    def sign(self) -> str:
        """The sign, which tells it without colours."""
        return self.value[0]

    @property
    def kind(self) -> Kind:
        """How it looks."""
        return self.value[1]


@dataclass(frozen=True)
class Row:
    """A check: what it asks, how it stands, what was expected and seen, and the moment to look at."""

    asks: str
    standing: Standing = Standing.OPEN
    detail: str = ""
    at: Nanoseconds | None = None


@dataclass(frozen=True)
class Sheet:
    """Everything that the pane tells.

    ``news`` says how the exercise stands, ``faults`` what else is wrong with the run, ``asks`` what is to be
    done. Each is a sentence or more.
    """

    news: str
    standing: Standing
    rows: tuple[Row, ...]
    faults: tuple[str, ...] = ()
    asks: str = ""

    @property
    def note(self) -> str:
        """How many checks passed, as short as it can be said; "" where none was judged."""
        passed = sum(row.standing is Standing.PASSED for row in self.rows)
        judged = any(row.standing is not Standing.OPEN for row in self.rows)
        return f"{self.standing.sign} {passed} of {len(self.rows)} pass" if judged else ""


class Line(NamedTuple):
    """Pieces of text with their kinds, and the place of the check that the line is about, if it is."""

    pieces: tuple[tuple[str, Kind], ...]
    row: int | None = None


def lines_of(sheet: Sheet, width: int) -> list[Line]:
    """Return the lines of a sheet, each at most ``width`` columns wide."""
    return list(_lines(sheet, max(_LEAST_WIDTH, width)))


def _lines(sheet: Sheet, width: int) -> Iterator[Line]:
    yield from _signed(sheet.standing, sheet.news, Kind.TITLE, width)
    for place, row in enumerate(sheet.rows):
        for line in _signed(row.standing, row.asks, Kind.ASKS, width):
            yield line._replace(row=place)
        for text in _wrapped(row.detail, width - _INDENT):
            yield Line(((f"{' ' * _INDENT}{text}", Kind.DETAIL),), place)
    yield from _titled("What is asked")
    yield from (Line(((text, Kind.TEXT),)) for text in _wrapped(sheet.asks, width))
    if sheet.faults:
        yield from _titled("What else is wrong with the run")
    for fault in sheet.faults:
        yield from _signed(Standing.WRONG, fault, Kind.TEXT, width)


def _titled(title: str) -> Iterator[Line]:
    yield Line(())
    yield Line(((title, Kind.TITLE),))


def _signed(standing: Standing, text: str, kind: Kind, width: int) -> Iterator[Line]:
    first, *others = _wrapped(text, width - _INDENT) or [""]
    yield Line(((f"{standing.sign} ", standing.kind), (first, kind)))
    for other in others:
        yield Line(((" " * _INDENT, kind), (other, kind)))


def _wrapped(text: str, width: int) -> list[str]:
    return wrap(visible(text, Charset.BRAILLE), width, break_on_hyphens=False)
