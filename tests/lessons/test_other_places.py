"""Lessons that do not come with the package: in folders that are named, and in packages that announce any."""

from pathlib import Path

import pytest

from cbtui.learning.lesson_scaffold import make_lesson
from lessons import catalogue
from lessons.catalogue import VARIABLE, faults, find, lessons, lessons_in
from lessons.lesson import BadLesson

OWN = len(lessons())


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with two lessons, which the environment names."""
    for number, name in ((2, "second-thing"), (1, "third-thing")):
        make_lesson(tmp_path / name)
        path = tmp_path / name / "lesson.toml"
        path.write_text(path.read_text().replace("number = 1", f"number = {number}"))
    monkeypatch.setenv(VARIABLE, str(tmp_path))
    return tmp_path


def announce(monkeypatch: pytest.MonkeyPatch, installed: Path, value: str) -> None:
    """Have a distribution in a folder with one entry point of the group, and read the lessons anew."""
    info = installed / "theirs-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: theirs\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(f"[{catalogue.ENTRY_POINTS}]\ntheirs = {value}\n")
    monkeypatch.syspath_prepend(str(installed))
    monkeypatch.setattr(catalogue, "_catalogue", catalogue._catalogue.__wrapped__)


def test_lessons_of_a_folder_follow_the_packages_own_in_the_order_of_their_numbers(folder: Path) -> None:
    assert [lesson.id for lesson in lessons()][OWN:] == ["third-thing", "second-thing"]
    assert [lesson.number for lesson in lessons()] == list(range(1, OWN + 3))


def test_they_are_found_by_their_ids(folder: Path) -> None:
    assert find("third-thing").folder == folder / "third-thing"


def test_without_the_variable_there_are_none(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(VARIABLE)
    assert len(lessons()) == OWN


def test_a_lessons_own_folder_can_be_named(folder: Path) -> None:
    assert [lesson.id for lesson in lessons_in(folder / "third-thing")] == ["third-thing"]


def test_a_folder_that_is_named_twice_counts_once(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, f"{folder}:{folder}")
    assert len(lessons()) == OWN + 2


def test_of_two_lessons_with_one_id_the_second_is_at_fault_with_both_places(
    folder: Path, tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch
) -> None:
    other = tmp_path_factory.mktemp("other")
    make_lesson(other / "third-thing")
    monkeypatch.setenv(VARIABLE, f"{folder}:{other}")
    assert find("third-thing").folder == folder / "third-thing"
    (fault,) = faults()
    assert str(fault) == (
        f"{other}/third-thing/lesson.toml: the field 'id' is wrong: "
        f"the lesson in {folder}/third-thing is called 'third-thing' too"
    )


def test_a_lesson_at_fault_is_left_out_and_told_when_it_is_asked_for(folder: Path) -> None:
    (folder / "second-thing" / "guide.md").unlink()
    assert [lesson.id for lesson in lessons()][OWN:] == ["third-thing"]
    sentence = f"{folder}/second-thing/lesson.toml: there is no file 'guide.md' beside it"
    assert [str(fault) for fault in faults()] == [sentence]
    with pytest.raises(BadLesson) as caught:
        find("second-thing")
    assert str(caught.value) == sentence


@pytest.mark.parametrize(
    ("make", "sentence"),
    [(False, "CBTUI_LESSONS: there is no folder "), (True, "CBTUI_LESSONS: there is no lesson in ")],
)
def test_a_place_without_lessons_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, make: bool, sentence: str
) -> None:
    place = tmp_path / "place"
    if make:
        place.mkdir()
    monkeypatch.setenv(VARIABLE, str(place))
    with pytest.raises(BadLesson) as caught:
        lessons()
    assert str(caught.value) == f"{sentence}{place}"


def test_a_package_announces_its_lessons_by_an_entry_point(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    package = tmp_path / "their_lessons"
    make_lesson(package / "their-thing")
    (package / "__init__.py").write_text("raise RuntimeError('nobody has to import this')\n")
    announce(monkeypatch, tmp_path, "their_lessons")
    assert find("their-thing").folder == package / "their-thing"


@pytest.mark.parametrize("value", ["no_such_package", "no_such.package", "json.decoder", ""])
def test_an_entry_point_that_names_no_package_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, value: str
) -> None:
    announce(monkeypatch, tmp_path, value)
    with pytest.raises(BadLesson) as caught:
        lessons()
    assert str(caught.value) == f"the entry point 'theirs' of cbtui.lessons: there is no package {value!r}"
