"""The results of an exercise's checks, and their lines of styled text."""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum, StrEnum
from typing import NamedTuple

from cbtui.runs.judged.check_text import FAILED, PASSED
from cbtui.text.cells import lines_of_text
from sim.trace.model import Nanoseconds

_INDENT = 2
_LEAST_WIDTH = 20


class ChecksStyle(StrEnum):
    """The style of a piece of text; the value is its component class."""

    PASSED = "checks--passed"
    FAILED = "checks--failed"
    OPEN = "checks--open"
    ASKS = "checks--asks"
    DETAIL = "checks--detail"
    TITLE = "checks--title"
    TEXT = "checks--text"


class CheckStatus(Enum):
    """The status of a check or exercise: a sign and its style."""

    PASSED = (PASSED, ChecksStyle.PASSED)
    FAILED = (FAILED, ChecksStyle.FAILED)
    OPEN = ("·", ChecksStyle.OPEN)
    WRONG = ("!", ChecksStyle.FAILED)

    @property
    def sign(self) -> str:
        """The sign, which is distinct without colours."""
        return self.value[0]

    @property
    def kind(self) -> ChecksStyle:
        """The style."""
        return self.value[1]


@dataclass(frozen=True)
class CheckRow:
    """A check: its question, status, expectation and observation, and the moment to look at."""

    asks: str
    status: CheckStatus = CheckStatus.OPEN
    detail: str = ""
    at: Nanoseconds | None = None


@dataclass(frozen=True)
class ChecksSheet:
    """The content of the pane.

    ``news`` is the state of the exercise, ``faults`` are other faults of the run, ``asks`` is the task, all
    in sentences.
    """

    news: str
    status: CheckStatus
    rows: tuple[CheckRow, ...]
    faults: tuple[str, ...] = ()
    asks: str = ""

    @property
    def note(self) -> str:
        """The number of passed checks in brief; "" if none was judged."""
        judged = any(row.status is not CheckStatus.OPEN for row in self.rows)
        return f"{self.status.sign} {self._passed} of {len(self.rows)} pass" if judged else ""

    @property
    def count(self) -> str:
        """The number of passed checks: ``2/5``; ``✓`` if the exercise is done."""
        is_done = self.status is CheckStatus.PASSED
        return self.status.sign if is_done else f"{self._passed}/{len(self.rows)}"

    @property
    def _passed(self) -> int:
        return sum(row.status is CheckStatus.PASSED for row in self.rows)


class ChecksLine(NamedTuple):
    """Styled pieces of text, and the index of the check that the line is about, if any."""

    pieces: tuple[tuple[str, ChecksStyle], ...]
    row: int | None = None


def lines_of(sheet: ChecksSheet, width: int) -> list[ChecksLine]:
    """Return the lines of a sheet, each at most ``width`` columns wide."""
    return list(_lines(sheet, max(_LEAST_WIDTH, width)))


def _lines(sheet: ChecksSheet, width: int) -> Iterator[ChecksLine]:
    yield from _signed(sheet.status, sheet.news, ChecksStyle.TITLE, width)
    for place, row in enumerate(sheet.rows):
        for line in _signed(row.status, row.asks, ChecksStyle.ASKS, width):
            yield line._replace(row=place)
        for text in lines_of_text(row.detail, width - _INDENT):
            yield ChecksLine(((f"{' ' * _INDENT}{text}", ChecksStyle.DETAIL),), place)
    yield from _titled("What the exercise asks")
    yield from (ChecksLine(((text, ChecksStyle.TEXT),)) for text in lines_of_text(sheet.asks, width))
    others = [fault for fault in sheet.faults if not any(fault in row.detail for row in sheet.rows)]
    if others:
        yield from _titled("What else is wrong with the run")
    for fault in others:
        yield from _signed(CheckStatus.WRONG, fault, ChecksStyle.TEXT, width)


def _titled(title: str) -> Iterator[ChecksLine]:
    yield ChecksLine(())
    yield ChecksLine(((title, ChecksStyle.TITLE),))


def _signed(status: CheckStatus, text: str, kind: ChecksStyle, width: int) -> Iterator[ChecksLine]:
    first, *others = lines_of_text(text, width - _INDENT) or [""]
    yield ChecksLine(((f"{status.sign} ", status.kind), (first, kind)))
    for other in others:
        yield ChecksLine(((" " * _INDENT, kind), (other, kind)))
