"""What a lesson.toml may say, and the sentence for one that says something else."""

from collections.abc import Callable
from pathlib import Path

import pytest

from lessons.lesson import BadLesson, Lesson, Try, read_lesson

WHOLE = """\
id = "two-cooks"
number = 7
unit = "6 Kitchens"
title = "Two cooks"
teaches = "Two cooks need two stoves."
executor = "MultiThreadedExecutor(2)"
groups = "2 exclusive"

[setup]
node = "node.py"
arguments = ["-wait", "5.0", "-threads", "2", "-loud"]
threads_argument = "-threads"

[service]
name = "/cook"
type = "std_srvs/srv/SetBool"

[[try]]
key = "s"
text = "Call for the cook."
"""

Kitchen = Callable[[str], Path]


@pytest.fixture
def kitchen(tmp_path: Path) -> Kitchen:
    """Return a function that makes a complete lesson folder with the given lesson.toml."""

    def make(toml: str) -> Path:
        folder = tmp_path / "two-cooks"
        folder.mkdir()
        (folder / "lesson.toml").write_text(toml, encoding="utf-8")
        (folder / "guide.md").write_text("# Two cooks, très chauds\n", encoding="utf-8")
        (folder / "node.py").write_text("", encoding="utf-8")
        return folder

    return make


def sentence_about(folder: Path) -> str:
    with pytest.raises(BadLesson) as caught:
        read_lesson(folder)
    sentence = str(caught.value)
    file = str(folder / "lesson.toml")
    assert sentence.startswith(f"{file}: ")
    return sentence.removeprefix(f"{file}: ")


def test_a_lesson_holds_what_its_file_says(kitchen: Kitchen) -> None:
    folder = kitchen(WHOLE)
    lesson = read_lesson(folder)
    assert (lesson.id, lesson.number, lesson.title) == ("two-cooks", 7, "Two cooks")
    assert (lesson.service.name, lesson.service.type) == ("/cook", "std_srvs/srv/SetBool")
    assert lesson.tries == (Try(key="s", text="Call for the cook."),)
    assert lesson.folder == folder
    assert lesson.node_path == folder / "node.py"
    assert lesson.guide == "# Two cooks, très chauds\n"


def test_a_lesson_cannot_be_changed(kitchen: Kitchen) -> None:
    lesson = read_lesson(kitchen(WHOLE))
    with pytest.raises(AttributeError):
        lesson.title = "Three cooks"  # type: ignore[misc]


@pytest.mark.parametrize(
    ("threads", "arguments"),
    [
        (None, ["-wait", "5.0", "-threads", "2", "-loud"]),
        (2, ["-wait", "5.0", "-threads", "2", "-loud"]),
        (16, ["-wait", "5.0", "-threads", "16", "-loud"]),
    ],
)
def test_a_number_of_threads_replaces_the_lessons_own(
    kitchen: Kitchen, threads: int | None, arguments: list[str]
) -> None:
    assert read_lesson(kitchen(WHOLE)).arguments_with(threads) == arguments


def test_a_number_of_threads_is_added_where_the_lesson_gives_none(kitchen: Kitchen) -> None:
    lesson = read_lesson(kitchen(WHOLE.replace('"-threads", "2", ', "")))
    assert lesson.arguments_with(None) == ["-wait", "5.0", "-loud"]
    assert lesson.arguments_with(3) == ["-wait", "5.0", "-loud", "-threads", "3"]


def test_a_node_without_an_argument_for_threads_keeps_its_command_line(kitchen: Kitchen) -> None:
    lesson = read_lesson(kitchen(WHOLE.replace('threads_argument = "-threads"', "")))
    assert lesson.arguments_with(3) == ["-wait", "5.0", "-threads", "2", "-loud"]


def test_changing_the_arguments_handed_out_changes_no_lesson(kitchen: Kitchen) -> None:
    lesson: Lesson = read_lesson(kitchen(WHOLE))
    lesson.arguments_with(None).clear()
    assert lesson.arguments_with(None) == ["-wait", "5.0", "-threads", "2", "-loud"]


@pytest.mark.parametrize(
    ("right", "wrong", "sentence"),
    [
        ('title = "Two cooks"\n', "", "the field 'title' is missing"),
        ('node = "node.py"\n', "", "the field 'setup.node' is missing"),
        ('text = "Call for the cook."\n', "", "the field 'try[0].text' is missing"),
        ("number = 7", "number = 7\nstars = 5", "the field 'stars' is not known"),
        ("number = 7", 'number = 7\nfolder = "/"', "the field 'folder' is not known"),
        ('name = "/cook"', 'name = "/cook"\nqos = 1', "the field 'service.qos' is not known"),
        ("number = 7", 'number = "7"', "the field 'number' is wrong: expected `int`, got `str`"),
        ("number = 7", "number = 0", "the field 'number' is wrong: expected `int` >= 1"),
        ('"Two cooks"', '""', "the field 'title' is wrong: expected `str` of length >= 1"),
        ('"5.0"', "5.0", "the field 'setup.arguments[1]' is wrong: expected `str`, got `float`"),
        (
            'id = "two-cooks"',
            'id = "cooks"',
            "the field 'id' is wrong: 'cooks' is not the name of its folder",
        ),
        ('"node.py"', '"chef.py"', "the field 'setup.node' is wrong: there is no file 'chef.py' beside it"),
        (
            ', "2", "-loud"]',
            "]",
            "the field 'setup' is wrong: -threads stands last in arguments and has no number after it",
        ),
    ],
)
def test_a_bad_field_is_named_with_its_fault(kitchen: Kitchen, right: str, wrong: str, sentence: str) -> None:
    assert right in WHOLE
    assert sentence_about(kitchen(WHOLE.replace(right, wrong, 1))) == sentence


@pytest.mark.parametrize(
    ("right", "wrong", "field"),
    [
        ('id = "two-cooks"', 'id = "Two Cooks"', "id"),
        ('"node.py"', '"../node.py"', "setup.node"),
        ('"/cook"', '"cook"', "service.name"),
        ('"std_srvs/srv/SetBool"', '"std_srvs/SetBool"', "service.type"),
    ],
)
def test_a_name_of_the_wrong_form_is_refused(kitchen: Kitchen, right: str, wrong: str, field: str) -> None:
    sentence = sentence_about(kitchen(WHOLE.replace(right, wrong, 1)))
    assert sentence.startswith(f"the field '{field}' is wrong: expected `str` matching")


def test_a_file_that_is_not_toml_is_said_to_be_so(kitchen: Kitchen) -> None:
    sentence = sentence_about(kitchen(WHOLE.replace("number = 7", "number 7")))
    assert sentence.startswith("is not valid TOML: ")
    assert "(at line 2, " in sentence


def test_a_file_that_is_not_utf8_is_said_not_to_be_toml(kitchen: Kitchen) -> None:
    folder = kitchen(WHOLE)
    (folder / "lesson.toml").write_bytes(b'id = "\xff"')
    assert sentence_about(folder).startswith("is not valid TOML: ")


def test_a_missing_file_is_said_to_be_unreadable(kitchen: Kitchen) -> None:
    folder = kitchen(WHOLE)
    (folder / "lesson.toml").unlink()
    assert sentence_about(folder) == "cannot be read: No such file or directory"


def test_a_lesson_without_a_guide_is_refused(kitchen: Kitchen) -> None:
    folder = kitchen(WHOLE)
    (folder / "guide.md").unlink()
    assert sentence_about(folder) == "there is no file 'guide.md' beside it"
