"""What lint-lesson finds wrong in a lesson, each fault in one sentence."""

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from cbtui.learning import lesson_lint
from cbtui.learning.lesson_lint import faults_in_runs, faults_in_texts, faults_of
from cbtui.learning.lesson_scaffold import TEMPLATE
from lessons.judge import Judge
from lessons.lesson import Lesson, read_lesson
from tests.support.daily import first_row_daily


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A lesson that is right."""
    return Path(shutil.copytree(TEMPLATE, tmp_path / TEMPLATE.name))


def change(path: Path, old: str, new: str) -> None:
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


@pytest.mark.parametrize(
    ("file", "old", "new", "fault"),
    first_row_daily(
        (
            "lesson.toml",
            "number = 1",
            "number = 0",
            "lesson.toml:3: the field 'number' is wrong: expected `int` >= 1",
        ),
        (
            "checks.py",
            "CHECKS =",
            "CHECK =",
            "checks.py: the exercise needs a tuple CHECKS with at least one check",
        ),
        (
            "lesson.toml",
            "right = 1",
            "right = 0",
            "lesson.toml: 'There are two timers and two threads. What does blink do while work sleeps?': "
            "right is 0, and the run shows 1, 'It waits until work is over'",
        ),
        (
            "lesson.toml",
            'node = ["group-starvation"]',
            "node = []",
            "node.py: the diagnosis finds group-starvation, which [diagnoses] does not declare",
        ),
        (
            "lesson.toml",
            "solution = []",
            'solution = ["stale-data"]',
            "solution.py: the diagnosis does not find stale-data, which [diagnoses] declares",
        ),
    ),
)
def test_what_does_not_come_out_so_is_told_with_its_file(
    folder: Path, file: str, old: str, new: str, fault: str
) -> None:
    change(folder / file, old, new)
    assert list(faults_of(folder)) == [f"{folder}/{fault}"]


@pytest.mark.parametrize(
    ("file", "old", "new", "fault"),
    [
        ("guide.md", "`t` changes", "`%` changes", "guide.md: no key `%` exists"),
        ("explain.md", "there is", "there is (`ctrl+f9`)", "explain.md: no key `ctrl+f9` exists"),
        ("lesson.toml", 'key = "t"', 'key = "%"', "lesson.toml: no key '%' exists, which a [[try]] names"),
        ("lesson.toml", "Press `space`", "Press `end`", "lesson.toml: no key `end` exists"),
        (
            "guide.md",
            "# Scaffold",
            "# Scaffolding",
            "guide.md:1: the first line is not the title, '# Scaffold'",
        ),
        (
            "guide.md",
            "Say in two sentences",
            "Say in two sentences, " + "x" * 60,
            "guide.md:3: the line is 104 characters long; 79 fit",
        ),
    ],
)
def test_a_text_that_is_at_fault_is_told_with_its_file(
    folder: Path, file: str, old: str, new: str, fault: str
) -> None:
    change(folder / file, old, new)
    assert list(faults_in_texts(read_lesson(folder))) == [f"{folder}/{fault}"]


@pytest.mark.slow
def test_a_starter_that_passes_leaves_nothing_to_mend(folder: Path) -> None:
    shutil.copyfile(folder / "solution.py", folder / "starter.py")
    assert list(faults_of(folder)) == [
        f"{folder}/starter.py: the diagnosis does not find group-starvation, which [diagnoses] declares",
        f"{folder}/starter.py: passes every check, so that there is nothing to mend",
    ]


@pytest.mark.slow
def test_a_solution_that_fails_a_check_is_none(folder: Path) -> None:
    change(folder / "solution.py", "time.sleep(2.0)", "time.sleep(1.0)")
    (fault,) = faults_of(folder)
    assert fault == (
        f"{folder}/solution.py: fails 'blink keeps coming while work runs': "
        "expected at least 1.5 calls a second; saw no long stretch in which work runs"
    )


def test_of_a_node_that_does_not_run_it_is_told_why(folder: Path) -> None:
    change(folder / "node.py", "class Blinker(Node):", "class Blinker(Node)")
    *_, said = faults_of(folder)
    assert said.startswith(f"{folder}/node.py: node.py:")
    assert "expected ':'" in said


@pytest.mark.bulk
def test_a_solution_that_does_not_run_is_said_to_be_so(folder: Path) -> None:
    change(folder / "solution.py", "class Blinker(Node):", "class Blinker(Node)")
    faults = list(faults_of(folder))
    assert faults[0].startswith(f"{folder}/solution.py: solution.py:")
    assert "expected ':'" in faults[0]


@pytest.mark.bulk
def test_a_starter_that_does_not_run_is_something_to_mend(folder: Path) -> None:
    change(folder / "starter.py", "class Blinker(Node):", "class Blinker(Node)")
    change(folder / "lesson.toml", 'starter = ["group-starvation"]', "starter = []")
    assert list(faults_of(folder)) == []


def test_a_rule_that_does_not_exist_is_named_once(folder: Path) -> None:
    change(folder / "lesson.toml", "group-starvation", "no-such-rule")
    assert list(faults_in_texts(read_lesson(folder))) == [
        f"{folder}/lesson.toml: the diagnosis has no rule 'no-such-rule'"
    ]


@pytest.mark.bulk
def test_a_node_that_ends_its_process_is_told_once(folder: Path) -> None:
    node = folder / "node.py"
    node.write_text("import os\nos._exit(3)\n" + node.read_text())
    assert list(faults_of(folder)) == [
        f"{folder}/node.py: node.py ended its whole process at 0.000 s: "
        "the program ended its process by os._exit(), with exit code 3 (node.py:2, in <module>)"
    ]


def test_a_lesson_without_a_question_is_incomplete(folder: Path) -> None:
    text = (folder / "lesson.toml").read_text()
    start, end = text.index("[[prediction]]"), text.index("[run]")
    (folder / "lesson.toml").write_text(text[:start] + text[end:])
    assert list(faults_in_texts(read_lesson(folder))) == [
        f"{folder}/lesson.toml: there is no [[prediction]]; a lesson asks one or two"
    ]


def test_on_the_real_clock_a_fault_counts_only_if_longer_runs_have_it_too(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    change(folder / "lesson.toml", "[setup]", '[setup]\nclock = "real"')
    lesson = read_lesson(folder)
    lengths: list[float] = []

    def faults(lesson: Lesson, _judge: Judge, _limit: float) -> Iterator[str]:
        lengths.append(lesson.run.seconds)
        if lesson.run.seconds < enough:
            yield "the computer was busy"

    monkeypatch.setattr(lesson_lint, "_faults_in_runs", faults)
    enough = 20.0
    assert list(faults_in_runs(lesson, Judge(lesson), 60.0)) == []
    enough = 50.0
    assert list(faults_in_runs(lesson, Judge(lesson), 60.0)) == ["the computer was busy"]
    assert lengths == [10, 30, 10, 30]


def test_a_line_that_starter_and_solution_share_and_the_node_lacks_is_a_fault_unless_it_is_explained(
    folder: Path,
) -> None:
    for file in ("starter.py", "solution.py"):
        path = folder / file
        path.write_text(path.read_text() + "\nSPARE = 1\n")
    (fault,) = faults_in_texts(read_lesson(folder))
    assert "solution.py has this line too, and node.py has not" in fault
    description = folder / "lesson.toml"
    described = description.read_text().replace("[exercise]\n", '[exercise]\nbeyond_node = "A spare."\n')
    description.write_text(described)
    assert list(faults_in_texts(read_lesson(folder))) == []


@pytest.mark.parametrize("file", ["guide.md", "explain.md", "lesson.toml"])
def test_a_text_that_is_not_utf8_is_told_with_file_and_line(folder: Path, file: str) -> None:
    path = folder / file
    before = path.read_bytes()
    path.write_bytes(before + b"# caf\xe9\n")
    line = before.count(b"\n") + 1
    assert next(faults_of(folder)) == f"{path}:{line}: the byte 0xe9 is not UTF-8; save the file as UTF-8"


def test_a_starter_that_is_not_utf8_does_not_stop_the_search_for_faults(folder: Path) -> None:
    with (folder / "starter.py").open("ab") as file:
        file.write(b"# caf\xe9\n")
    assert list(faults_in_texts(read_lesson(folder))) == []
