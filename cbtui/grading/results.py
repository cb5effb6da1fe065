"""Results of graded hand-ins beyond their marks: JUnit XML, and the number of misses of each check."""

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby
from operator import itemgetter
from xml.etree import ElementTree

from cbtui.grading.mark_sheet import SheetRow, check_results

_NOT_IN_XML = re.compile(r"[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def missed_text(rows: Sequence[SheetRow], asked: Mapping[str, Sequence[str]]) -> str:
    """Return each lesson's checks, the most missed first, with the share of judged hand-ins that missed them.

    ``asked`` are the questions of each lesson's checks. The text is empty if no check was missed.
    """
    lines = list(_missed_lines(rows, asked))
    return "".join(f"{line}\n" for line in ("", "Missed most:", *lines)) if lines else ""


def _missed_lines(rows: Sequence[SheetRow], asked: Mapping[str, Sequence[str]]) -> Iterator[str]:
    for lesson, graded in _by_lesson(rows):
        judged = [[*check_results(row)] for row in graded if row["total"] != "0"]
        everybody = sum(map(bool, judged))
        missed = Counter(
            number for results in judged for number, (passed, _) in enumerate(results) if not passed
        )
        for number, times in missed.most_common():
            yield f"  {times} of {everybody}  {lesson}: {asked[lesson][number]}"


def junit_xml(rows: Sequence[SheetRow], asked: Mapping[str, Sequence[str]]) -> str:
    """Return the results as JUnit XML: a suite for each lesson, a case for each check of each learner.

    A hand-in that could not be judged, or is suspicious, is an error.
    """
    root = ElementTree.Element("testsuites", name="cbtui grade")
    for lesson, graded in _by_lesson(rows):
        suite = ElementTree.SubElement(root, "testsuite", name=_plain(lesson or "no lesson"))
        for row in graded:
            _add_cases(suite, row, asked.get(lesson, ()))
        for count, found in (("tests", "testcase"), ("failures", "*/failure"), ("errors", "*/error")):
            suite.set(count, str(len(suite.findall(found))))
    ElementTree.indent(root)
    return f"<?xml version='1.0' encoding='utf-8'?>\n{ElementTree.tostring(root, encoding='unicode')}\n"


def _add_cases(suite: ElementTree.Element, row: SheetRow, asked: Sequence[str]) -> None:
    who = _plain(f"{row['lesson'] or 'no lesson'}.{row['learner']}")
    for asks, (passed, line) in zip(asked, check_results(row), strict=False):
        case = ElementTree.SubElement(suite, "testcase", classname=who, name=_plain(asks))
        if not passed:
            ElementTree.SubElement(case, "failure", message=_plain(line))
    for what in ("problem", "suspicious"):
        if row[what]:
            case = ElementTree.SubElement(suite, "testcase", classname=who, name=what)
            ElementTree.SubElement(case, "error", message=_plain(row[what]))


def _by_lesson(rows: Sequence[SheetRow]) -> Iterator[tuple[str, list[SheetRow]]]:
    for lesson, graded in groupby(sorted(rows, key=itemgetter("lesson")), key=itemgetter("lesson")):
        yield lesson, list(graded)


def _plain(text: str) -> str:
    """Return a text without characters that XML cannot contain, as output of programs may have them."""
    return _NOT_IN_XML.sub("�", text)
