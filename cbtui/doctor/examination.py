"""What an examination says of one thing: a sign, what there is, and what to do if it is not well."""

from enum import Enum
from typing import NamedTuple


class Sign(Enum):
    """How it is with one thing."""

    WELL = "✓"
    NOTE = "!"
    """Something is less than it could be, and cbtui works."""
    FAULT = "✗"
    """Something that cbtui needs is not there, or broken."""

    @property
    def plain(self) -> str:
        """The sign in ASCII."""
        return {Sign.WELL: "+", Sign.NOTE: "!", Sign.FAULT: "x"}[self]


class Examination(NamedTuple):
    """What was found; ``remedy`` says what to do, and is empty where nothing is to be done."""

    sign: Sign
    subject: str
    what: str
    remedy: str = ""


def well(subject: str, what: str) -> Examination:
    """Say that a thing is as it should be."""
    return Examination(Sign.WELL, subject, what)


def note(subject: str, what: str, remedy: str) -> Examination:
    """Say that a thing could be better."""
    return Examination(Sign.NOTE, subject, what, remedy)


def fault(subject: str, what: str, remedy: str) -> Examination:
    """Say that a thing is not well."""
    return Examination(Sign.FAULT, subject, what, remedy)
