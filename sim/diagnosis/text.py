"""Findings as plain text for a terminal, 79 columns wide where names allow."""

from collections.abc import Iterator, Sequence
from textwrap import TextWrapper

from sim.diagnosis.rule import Explanation, Finding, Weight
from sim.quantities.durations import timestamp
from sim.trace.timeline import Timeline

SIGNS = {Weight.PROBLEM: "!", Weight.REMARK: "·"}
WIDTH = 79


def findings_text(findings: Sequence[Finding], timeline: Timeline) -> str:
    """A list of findings, each with why, what to do, when and where; nothing for none.

    ``!`` marks what goes wrong, ``·`` what is only worth knowing.
    """
    if not findings:
        return ""
    lines = ["Diagnosis"]
    for found in findings:
        lines += _lines(found, timeline)
    return "\n".join([*lines, ""])


def _lines(found: Finding, timeline: Timeline) -> Iterator[str]:
    weight = found.weight_in(timeline)
    explanation = found.explained(timeline)
    yield from _wrapped(f"  {SIGNS[weight]} ", with_stop(explanation.what))
    yield from _wrapped("    ", sentence(explanation.why))
    yield from _wrapped("    → ", with_stop(explanation.cure))
    where = location_text(found, explanation)
    if where:
        yield f"      {where}"


def sentence(text: str) -> str:
    """Return a clause as a sentence; a piece of code at its beginning keeps its case."""
    first = text.partition(" ")[0]
    return with_stop(text if "(" in first or "_" in first else f"{text[:1].upper()}{text[1:]}")


def with_stop(text: str) -> str:
    """Return a text with a full stop at its end, unless it ends in one or in a question mark."""
    return text if text.endswith((".", "?")) else f"{text}."


def location_text(found: Finding, explanation: Explanation) -> str:
    """The source line and time of a finding: ``node.py:58, at 4.006 s``."""
    place = [] if explanation.place is None else [str(explanation.place)]
    time = [f"at {timestamp(found.at)}"] if found.at else []
    return ", ".join([*place, *time])


def _wrapped(begin: str, text: str) -> list[str]:
    wrapper = TextWrapper(WIDTH, break_long_words=False, break_on_hyphens=False)
    wrapper.initial_indent, wrapper.subsequent_indent = begin, " " * len(begin)
    return wrapper.wrap(text)
