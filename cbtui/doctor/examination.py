"""The result of examining one requirement: a sign, the finding, and a remedy."""

from enum import Enum
from typing import NamedTuple


class Sign(Enum):
    """The state of a requirement."""

    WELL = "✓"
    NOTE = "!"
    """Not ideal, but cbtui works."""
    FAULT = "✗"
    """Something that cbtui needs is missing or broken."""

    @property
    def plain(self) -> str:
        """The sign in ASCII."""
        return {Sign.WELL: "+", Sign.NOTE: "!", Sign.FAULT: "x"}[self]


class Examination(NamedTuple):
    """What was found; ``remedy`` says what to do, if anything."""

    sign: Sign
    subject: str
    what: str
    remedy: str = ""


def well(subject: str, what: str) -> Examination:
    """Return the examination of a fulfilled requirement."""
    return Examination(Sign.WELL, subject, what)


def note(subject: str, what: str, remedy: str) -> Examination:
    """Return the examination of something that could be better."""
    return Examination(Sign.NOTE, subject, what, remedy)


def fault(subject: str, what: str, remedy: str) -> Examination:
    """Return the examination of a missing or broken requirement."""
    return Examination(Sign.FAULT, subject, what, remedy)
