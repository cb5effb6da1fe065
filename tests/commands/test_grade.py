"""Many learners' files, checked one after another into a table."""

import csv
import io
from pathlib import Path
from xml.etree import ElementTree

import pytest

from cbtui import cli
from cbtui.grading.grading import hand_ins_in
from tests.commands.exercise_files import LEAVES, LESSON, SOLUTION, STARTER, SYNTAX_ERROR


@pytest.fixture
def school(tmp_path: Path) -> Path:
    """A folder with what five learners handed in."""
    folder = tmp_path / "school"
    for learner, name, source in (
        ("ann", "split_groups.py", SOLUTION),
        ("bob", "split_groups.py", SYNTAX_ERROR),
        ("cyd", "notes.txt", "I was ill"),
    ):
        (folder / learner).mkdir(parents=True)
        (folder / learner / name).write_text(source)
    (folder / "dan_split_groups.py").write_text(STARTER)
    (folder / "eve.py").write_text(LEAVES)
    (folder / ".git").mkdir()
    (folder / "__pycache__").mkdir()
    return folder


def rows(text: str) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(text)))


def test_every_learner_has_a_row_whatever_the_one_before_did(
    school: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    junit = tmp_path / "results.xml"
    assert cli.main(["grade", str(school), "--csv", "--junit", str(junit)]) == 1
    no_lesson, suite = ElementTree.parse(junit).getroot()
    assert [suite.get(name) for name in ("name", "tests", "failures", "errors")] == [
        "split-groups",
        "11",
        "4",
        "1",
    ]
    assert [case.get("classname") for case in no_lesson] == ["no lesson.cyd", "no lesson.eve"]
    assert suite[0].attrib == {
        "classname": "split-groups.ann",
        "name": "/odom keeps coming while the robot rotates",
    }
    failures = {str(case.get("name")): failure.get("message") for case in suite for failure in case}
    assert failures["the robot makes 1 turn"] == (
        "the robot makes 1 turn; expected 1 turn; saw 2 turns, at 14.000 s"
    )
    assert failures["problem"] == "split_groups.py:28: expected ':'"
    table = rows(capsys.readouterr().out)
    assert list(table[0]) == [
        "learner",
        "lesson",
        "passed",
        "total",
        *(f"check {n}" for n in range(1, 6)),
        "problem",
        "suspicious",
        "digest",
    ]
    found = {row["learner"]: (row["lesson"], row["passed"], row["total"]) for row in table}
    assert found == {
        "ann": ("split-groups", "5", "5"),
        "bob": ("split-groups", "0", "5"),
        "cyd": ("", "0", "0"),
        "dan": ("split-groups", "1", "5"),
        "eve": ("", "0", "0"),
    }
    ann, bob, cyd, dan, eve = table
    assert ann["check 1"].startswith(
        "passed: /odom keeps coming while the robot rotates; expected at least 15"
    )
    assert dan["check 4"] == "failed: the robot makes 1 turn; expected 1 turn; saw 2 turns, at 14.000 s"
    assert (ann["problem"], dan["problem"]) == ("", "")
    assert bob["problem"] == "split_groups.py:28: expected ':'"
    assert cyd["problem"] == f"{school}/cyd has no file split_groups.py, nor one of another exercise"
    assert eve["problem"] == "eve.py does not tell by its name which exercise it is for"


@pytest.mark.bulk
def test_with_a_lesson_named_a_file_may_be_called_anything(
    school: Path, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    out = tmp_path / "marks.csv"
    assert cli.main(["grade", str(school), "--lesson", "split-groups", "--csv", str(out)]) == 1
    table = {row["learner"]: row for row in rows(out.read_text())}
    assert table["eve"]["problem"].startswith("eve.py ended its whole process")
    assert table["dan"]["passed"] == "1"
    printed = capsys.readouterr().out.splitlines()
    assert "5/5  ann  split-groups" in printed
    assert printed[-5:-3] == [
        "Missed most:",
        "  1 of 2  split-groups: /odom keeps coming while the robot rotates",
    ]


@pytest.mark.slow
def test_a_class_that_passes_ends_with_0(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "split_groups_zoe.py").write_text(SOLUTION)
    assert cli.main(["grade", str(tmp_path)]) == 0
    assert capsys.readouterr().out == "5/5  zoe  split-groups\n"


@pytest.mark.slow
def test_what_a_program_says_is_no_formula_in_a_spreadsheet(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "=HYPERLINK(1).py").write_text("raise SystemExit('=1+1')\n")
    assert cli.main(["grade", str(tmp_path), "--lesson", "split-groups", "--csv"]) == 1
    (row,) = rows(capsys.readouterr().out)
    assert not any(cell.startswith("=") for cell in row.values())


def test_a_file_is_told_by_its_name_before_or_behind_the_learners(tmp_path: Path) -> None:
    for name in ("split_groups-ann.py", "bob.split_groups.py", "split_groups.py"):
        (tmp_path / name).touch()
    found = [(paper.learner, paper.lesson) for paper in hand_ins_in(tmp_path, [LESSON], None)]
    assert sorted(found, key=lambda pair: pair[0]) == [
        ("ann", LESSON),
        ("bob", LESSON),
        ("split_groups", LESSON),
    ]


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["grade", "nowhere"], "there is no folder nowhere"),
        (["grade", __file__], f"{__file__} is not a folder"),
        (["grade", "."], ". has no learners' folders and no Python files in it"),
        (["grade", ".", "--lesson", "single-thread"], "the lesson single-thread has no exercise"),
    ],
)
def test_a_wrong_command_is_refused_in_one_line(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    words: list[str],
    sentence: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit, match="2"):
        cli.main(words)
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"cbtui: {sentence}")


def test_a_table_that_cannot_be_written_is_said_to_be_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "split_groups.py").write_text("")
    with pytest.raises(SystemExit, match="2"):
        cli.main(["grade", str(tmp_path), "--csv", str(tmp_path / "no" / "marks.csv")])
    assert "marks.csv cannot be written: there is no folder " in capsys.readouterr().err


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no device that is always full")
def test_a_table_on_a_full_disk_is_said_to_be_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "split_groups.py").write_text("")
    assert cli.main(["grade", str(tmp_path), "--csv", "/dev/full"]) == 1
    assert capsys.readouterr().err.endswith("cbtui: /dev/full cannot be written: No space left on device\n")


@pytest.mark.slow
def test_names_that_are_not_utf_8_keep_nobody_else_from_being_graded(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("split_groups_ann.py", "split_groups_b\udcf6b.py"):
        (tmp_path / name).write_text(LEAVES)
    assert cli.main(["grade", str(tmp_path), "--csv", str(tmp_path / "marks.csv")]) == 1
    _, ann, bob = (tmp_path / "marks.csv").read_text().splitlines()
    assert ann.startswith("ann,split-groups,0,")
    assert bob.startswith("b\\udcf6b,split-groups,0,5,")
    assert bob.endswith("its path is not UTF-8; rename it,,")
