"""The words of an exercise's checks, as text."""

from dataclasses import replace
from pathlib import Path

from cbtui.runs.judged.checking import CheckedFile, ObservedRun
from cbtui.widgets.checks import CheckRow, ChecksSheet, CheckStatus
from cbtui.widgets.checks.exercise_sheet import ExerciseKeys, ExerciseTexts
from cbtui.widgets.checks.sheet import lines_of
from lessons.catalogue import find
from lessons.checks import Check, Verdict
from lessons.judge import JudgedCheck
from sim.trace.timeline import Timeline

LESSON, NEXT = find("split-groups"), find("exclusive-2-threads")
NAMES = ("odom runs", "scan runs")


def verdict(passed: bool) -> Verdict:
    return Verdict(passed, "1 call", "2 calls", 4_000_000_000)


CHECKS = tuple(Check(name, lambda _: verdict(True)) for name in NAMES)
WORDS = ExerciseTexts(LESSON, CHECKS, "mine.py", NEXT, ExerciseKeys("o", "w", "e", "n"))


def checked(*passed: bool, trouble: str | None = None) -> CheckedFile:
    judged = tuple(JudgedCheck(check, verdict(each)) for check, each in zip(CHECKS, passed, strict=False))
    return CheckedFile(judged, len(CHECKS), ObservedRun(Timeline(), trouble))


def shown(sheet: ChecksSheet, width: int = 76) -> list[str]:
    return ["".join(text for text, _ in line.pieces) for line in lines_of(sheet, width)]


def test_each_check_tells_with_a_sign_what_was_expected_seen_and_when() -> None:
    lines = shown(WORDS.judged(checked(True, False)))
    assert lines[1:5] == [
        "✓ odom runs",
        "  expected 1 call; saw 2 calls, at 4.000 s",
        "✗ scan runs",
        "  expected 1 call; saw 2 calls, at 4.000 s",
    ]


def test_a_fault_that_a_check_has_told_is_not_told_as_another() -> None:
    row = CheckRow(
        "nothing gets stuck", CheckStatus.FAILED, "expected no deadlock; saw a waits for b, at 1.0 s"
    )
    sheet = ChecksSheet("", CheckStatus.FAILED, (row,), ("a waits for b",))
    assert "What else is wrong with the run" not in shown(sheet)
    more = shown(replace(sheet, faults=("a waits for b", "c raised KeyError")))
    assert more[-2:] == ["What else is wrong with the run", "! c raised KeyError"]


def test_the_lines_of_a_check_know_which_one_it_is() -> None:
    rows = [line.row for line in lines_of(WORDS.judged(checked(True, False)), 76)]
    assert rows[:6] == [None, 0, 0, 1, 1, None]


def test_what_fails_leads_to_the_editor() -> None:
    sheet = WORDS.judged(checked(True, False))
    assert sheet.news == "1 of 2 checks fails. o opens mine.py; saving it checks it again."
    assert (sheet.status, sheet.note) == (CheckStatus.FAILED, "✗ 1 of 2 pass")


def test_when_all_pass_it_is_said_what_comes_next() -> None:
    sheet = WORDS.judged(checked(True, True))
    assert sheet.news == (
        "All 2 checks pass: the exercise is done. n opens the next lesson, Exclusive, 2 threads."
    )
    assert (sheet.status, sheet.note) == (CheckStatus.PASSED, "✓ 2 of 2 pass")


def test_after_the_last_lesson_no_key_for_another_is_named() -> None:
    words = ExerciseTexts(LESSON, CHECKS, "mine.py", None, ExerciseKeys("o", "w", "e", "n"))
    assert " n " not in words.judged(checked(True, True)).news


def test_a_file_that_cannot_be_judged_is_told_of_and_no_check_has_a_verdict() -> None:
    sheet = WORDS.judged(checked(trouble="mine.py:3: expected ':'"))
    assert sheet.news.startswith("mine.py:3: expected ':'. o opens mine.py")
    assert [row.status for row in sheet.rows] == [CheckStatus.OPEN, CheckStatus.OPEN]
    assert sheet.note == ""


def test_a_question_gets_no_full_stop() -> None:
    sheet = WORDS.judged(checked(trouble="name 'spni' is not defined; did you mean 'spin'?"))
    assert sheet.news.startswith("name 'spni' is not defined; did you mean 'spin'? o opens mine.py")


def test_while_it_runs_it_tells_how_far_it_is() -> None:
    assert shown(WORDS.running(12_300_000_000))[0] == "· mine.py runs: 12.3 s of 30 s"


def test_what_is_asked_can_be_read_below_the_checks() -> None:
    lines = shown(WORDS.running(0))
    asks = " ".join(lines[lines.index("What the exercise asks") + 1 :])
    assert LESSON.exercise is not None
    assert asks == " ".join(LESSON.exercise.asks.split())


def test_markdown_is_for_the_page_alone() -> None:
    texts = ExerciseTexts(
        find("await-keeps-its-group"), CHECKS, "mine.py", NEXT, ExerciseKeys("o", "w", "e", "n")
    )
    assert "watch_callback has to go on" in " ".join(shown(texts.running(0)))
    assert "`watch_callback` has to go on" in texts.page(Path("mine.py"))


def test_no_line_is_wider_than_there_is_room_and_no_text_obeys_the_terminal() -> None:
    sheet = ChecksSheet(
        "word " * 30, CheckStatus.FAILED, (CheckRow("a" * 90, detail="\x1b[31m"),), ("b " * 60,), "c " * 90
    )
    for width in (32, 50, 76):
        lines = shown(sheet, width)
        assert max(map(len, lines)) <= width
        assert "\x1b" not in "".join(lines)
