"""Findings as plain text for a terminal, 79 wide where names allow."""

from collections.abc import Iterator, Sequence
from textwrap import TextWrapper

from sim.diagnosis.rule import Explanation, Finding, Weight
from sim.durations import timestamp
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
    weight = found.rule.weigh(found, timeline) or found.rule.weight
    told = found.rule.explain(found, timeline)
    yield from _wrapped(f"  {SIGNS[weight]} ", f"{told.what}.")
    yield from _wrapped("    ", sentence(told.why))
    yield from _wrapped("    → ", f"{told.cure}.")
    where = whereabouts(found, told)
    if where:
        yield f"      {where}"


def sentence(text: str) -> str:
    """A text as a sentence of its own."""
    return f"{text[:1].upper()}{text[1:]}."


def whereabouts(found: Finding, told: Explanation) -> str:
    """Where in the code and when in the run a finding is: ``node.py:58, at 4.006 s``."""
    place = [] if told.place is None else [str(told.place)]
    time = [f"at {timestamp(found.at)}"] if found.at else []
    return ", ".join([*place, *time])


def _wrapped(begin: str, text: str) -> list[str]:
    wrapper = TextWrapper(WIDTH, break_long_words=False, break_on_hyphens=False)
    wrapper.initial_indent, wrapper.subsequent_indent = begin, " " * len(begin)
    return wrapper.wrap(text)
