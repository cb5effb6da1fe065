"""What a lesson.toml may say, and the sentence for one that says something else."""

from collections.abc import Callable
from pathlib import Path

import pytest

from cbtui.runs.setup.lesson_setup import setup_for, setup_to_judge
from lessons.lesson import BadLesson, Lesson, Setting, Try, number_after, read_lesson
from sim.engine.setup import RobotUse

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


COURSE = """
[[prediction]]
question = "Two cooks, one stove: who cooks?"
answers = ["Both", "One after the other"]
right = 1
because = "A stove is for one."
shown = "who_cooks"

[run]
seconds = 12
calls = [2.5]
lines = [[3, "ros2 topic list"]]

[exercise]
asks = "Let both cook."
hints = ["Look at the stoves.", "There is one.", "Take two."]

[diagnoses]
starter = ["group-starvation"]
"""
"""What a lesson with a question and an exercise has besides."""


@pytest.fixture
def kitchen(tmp_path: Path) -> Kitchen:
    """Return a function that makes a complete lesson folder with the given lesson.toml."""

    def make(toml: str) -> Path:
        folder = tmp_path / "two-cooks"
        folder.mkdir()
        (folder / "lesson.toml").write_text(toml, encoding="utf-8")
        (folder / "guide.md").write_text("# Two cooks, très chauds\n", encoding="utf-8")
        for name in ("node.py", "starter.py", "solution.py", "checks.py"):
            (folder / name).write_text("", encoding="utf-8")
        return folder

    return make


def sentence_about(folder: Path) -> str:
    with pytest.raises(BadLesson) as caught:
        read_lesson(folder)
    sentence = str(caught.value)
    file = str(folder / "lesson.toml")
    place, sentence = sentence.split(": ", 1)
    assert place.split(":")[0] == file
    return sentence


def test_a_lesson_holds_what_its_file_says(kitchen: Kitchen) -> None:
    folder = kitchen(WHOLE)
    lesson = read_lesson(folder)
    assert (lesson.id, lesson.number, lesson.title) == ("two-cooks", 7, "Two cooks")
    assert (lesson.service.name, lesson.service.type) == ("/cook", "std_srvs/srv/SetBool")
    assert lesson.tries == (Try(key="s", text="Call for the cook."),)
    assert lesson.folder == folder
    assert lesson.node_path == folder / "node.py"
    assert lesson.guide == "# Two cooks, très chauds\n"


def test_a_lesson_names_the_numbers_that_can_be_changed(kitchen: Kitchen) -> None:
    setting = '[[setting]]\nname = "wait"\nargument = "-wait"\nunit = "s"\nleast = 0\nmost = 9\n'
    lesson = read_lesson(kitchen(WHOLE + setting))
    assert lesson.settings == (Setting(name="wait", argument="-wait", unit="s", least=0, most=9),)


@pytest.mark.parametrize(
    ("name", "number"), [("-wait", 5.0), ("-threads", 2.0), ("-loud", None), ("2", None), ("-no", None)]
)
def test_the_number_of_an_argument_stands_after_it(name: str, number: float | None) -> None:
    assert number_after(name, ["-wait", "5.0", "-threads", "2", "-loud"]) == number


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
            "[[try]]",
            '[[setting]]\nname = "wait"\nargument = "-w"\nunit = "s"\nleast = 0\nmost = 9\n[[try]]',
            "the setting 'wait' needs -w and a number in arguments",
        ),
        (
            "[[try]]",
            '[[setting]]\nname = "wait"\nargument = "-wait"\nunit = "s"\nleast = 9\nmost = 9\n[[try]]',
            "the field 'setting[0]' is wrong: the least 9 is not below the most 9",
        ),
        (
            "[[try]]",
            '[[setting]]\nname = "wait"\nargument = "-wait"\nleast = 0\nmost = 9\n[[try]]',
            "the field 'setting[0].unit' is missing",
        ),
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


def test_a_lesson_may_run_the_node_of_another_one(kitchen: Kitchen, tmp_path: Path) -> None:
    folder = kitchen(WHOLE.replace('"node.py"', '"../three-cooks/cooks.py"', 1))
    (tmp_path / "three-cooks").mkdir()
    (tmp_path / "three-cooks" / "cooks.py").touch()
    assert read_lesson(folder).node_path == tmp_path / "three-cooks" / "cooks.py"


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
    folder = kitchen(WHOLE.replace("number = 7", "number 7"))
    with pytest.raises(BadLesson) as caught:
        read_lesson(folder)
    assert str(caught.value) == (
        f"{folder}/lesson.toml:2: is not valid TOML: Expected '=' after a key in a key/value pair"
    )


@pytest.mark.parametrize(
    ("right", "wrong", "line"),
    [
        ("number = 7", 'number = "7"', ":2"),
        ('id = "two-cooks"', 'id = "cooks"', ":1"),
        ('"node.py"', '"chef.py"', ":10"),
        ('node = "node.py"\n', "", ":9"),
        ('"5.0"', "5.0", ":11"),
        ('[[try]]\nkey = "s"', '[[try]]\nkey = "r"\ntext = "text"\n[[try]]\nkey = 3', ":22"),
        ('title = "Two cooks"\n', "", ""),
    ],
)
def test_the_line_of_a_bad_field_or_of_its_table_is_named(
    kitchen: Kitchen, right: str, wrong: str, line: str
) -> None:
    folder = kitchen(WHOLE.replace(right, wrong, 1))
    with pytest.raises(BadLesson) as caught:
        read_lesson(folder)
    assert str(caught.value).startswith(f"{folder}/lesson.toml{line}: the field ")


def test_a_file_that_is_not_utf8_is_said_to_be_so_with_its_line(kitchen: Kitchen) -> None:
    folder = kitchen(WHOLE)
    (folder / "lesson.toml").write_bytes(b'# Two cooks\nid = "\xff"')
    with pytest.raises(BadLesson) as caught:
        read_lesson(folder)
    assert str(caught.value) == f"{folder}/lesson.toml:2: the byte 0xff is not UTF-8; save the file as UTF-8"


def test_a_missing_file_is_said_to_be_unreadable(kitchen: Kitchen) -> None:
    folder = kitchen(WHOLE)
    (folder / "lesson.toml").unlink()
    assert sentence_about(folder) == "cannot be read: No such file or directory"


def test_a_lesson_without_a_guide_is_refused(kitchen: Kitchen) -> None:
    folder = kitchen(WHOLE)
    (folder / "guide.md").unlink()
    assert sentence_about(folder) == "there is no file 'guide.md' beside it"


def test_a_lesson_holds_its_question_its_run_and_its_exercise(kitchen: Kitchen) -> None:
    folder = kitchen(WHOLE.replace("[setup]", 'task = "Call twice."\n[setup]') + COURSE)
    lesson = read_lesson(folder)
    assert lesson.task == "Call twice."
    (prediction,) = lesson.predictions
    assert (prediction.answers[prediction.right], prediction.shown) == ("One after the other", "who_cooks")
    assert (lesson.run.seconds, lesson.run.calls, lesson.run.lines) == (12, (2.5,), ((3, "ros2 topic list"),))
    assert lesson.exercise is not None
    assert lesson.exercise.hints[2] == "Take two."
    assert (lesson.starter_path, lesson.solution_path) == (folder / "starter.py", folder / "solution.py")
    assert lesson.file_name == "two_cooks.py"
    assert lesson.diagnoses.starter == ("group-starvation",)


def test_a_lesson_without_all_that_has_a_run_and_nothing_to_mend(kitchen: Kitchen) -> None:
    lesson = read_lesson(kitchen(WHOLE))
    assert (lesson.predictions, lesson.exercise, lesson.starter_path, lesson.explanation) == (
        (),
        None,
        None,
        "",
    )
    assert lesson.run.seconds == 30


def test_a_lesson_runs_on_virtual_time(kitchen: Kitchen) -> None:
    lesson = read_lesson(kitchen(WHOLE))
    for setup in (setup_for(lesson), setup_to_judge(lesson), setup_to_judge(lesson, Path("own.py"))):
        assert (setup.clock, setup.robot) == ("virtual", RobotUse.ALWAYS)


def test_a_lesson_that_names_the_real_clock_runs_on_that(kitchen: Kitchen) -> None:
    lesson = read_lesson(kitchen(WHOLE.replace("[setup]", '[setup]\nclock = "real"')))
    for setup in (setup_for(lesson), setup_to_judge(lesson), setup_to_judge(lesson, Path("own.py"))):
        assert (setup.clock, setup.robot) == ("real", RobotUse.WHEN_USED)


def test_a_clock_that_does_not_exist_is_refused(kitchen: Kitchen) -> None:
    sentence = sentence_about(kitchen(WHOLE.replace("[setup]", '[setup]\nclock = "wall"')))
    assert sentence == "the field 'setup.clock' is wrong: invalid enum value 'wall'"


def test_what_is_for_after_the_run_lies_beside_the_guide(kitchen: Kitchen) -> None:
    folder = kitchen(WHOLE)
    (folder / "explain.md").write_text("# Why\n\nÇa chauffe.\n", encoding="utf-8")
    assert read_lesson(folder).explanation == "# Why\n\nÇa chauffe.\n"


@pytest.mark.parametrize(
    ("right", "wrong", "sentence"),
    [
        (
            "right = 1",
            "right = 2",
            "the field 'prediction[0]' is wrong: right is 2, and the last answer has the number 1",
        ),
        ("right = 1", "right = -1", "the field 'prediction[0].right' is wrong: expected `int` >= 0"),
        (
            '"One after the other"',
            '"Both"',
            "the field 'prediction[0]' is wrong: two answers are the same",
        ),
        (
            ', "One after the other"',
            "",
            "the field 'prediction[0].answers' is wrong: expected `array` of length >= 2",
        ),
        ('shown = "who_cooks"', "", "the field 'prediction[0].shown' is missing"),
        (
            "calls = [2.5]",
            "calls = [12.5]",
            "the field 'run' is wrong: a call at 12.5 s comes when the run of 12 s is over",
        ),
        (
            "lines = [[3,",
            "lines = [[12,",
            "the field 'run' is wrong: a line at 12 s comes when the run of 12 s is over",
        ),
        (
            "lines = [[3,",
            'lines = [["3",',
            "the field 'run.lines[0][0]' is wrong: expected `float`, got `str`",
        ),
        ("seconds = 12", "seconds = 0", "the field 'run.seconds' is wrong: expected `float` > 0.0"),
        ("seconds = 12", "seconds = 12\nspeed = 2", "the field 'run.speed' is not known"),
        (
            ', "Take two."',
            "",
            "the field 'exercise.hints' is wrong: expected `array` of length 3, got 2",
        ),
        (
            "[exercise]",
            '[exercise]\nstarter = "begin.py"',
            "the field 'exercise.starter' is wrong: there is no file 'begin.py' beside it",
        ),
        ("starter = [", "learner = [", "the field 'diagnoses.learner' is not known"),
    ],
)
def test_a_bad_field_of_a_question_or_an_exercise_is_named_with_its_fault(
    kitchen: Kitchen, right: str, wrong: str, sentence: str
) -> None:
    assert right in COURSE
    assert sentence_about(kitchen(WHOLE + COURSE.replace(right, wrong, 1))) == sentence


def test_a_third_question_is_one_too_many(kitchen: Kitchen) -> None:
    question = COURSE[: COURSE.index("[run]")]
    sentence = sentence_about(kitchen(WHOLE + question * 3))
    assert sentence == "the field 'prediction' is wrong: expected `array` of length <= 2"


def test_diagnoses_of_a_starter_need_an_exercise(kitchen: Kitchen) -> None:
    sentence = sentence_about(kitchen(WHOLE + '[diagnoses]\nstarter = ["group-starvation"]\n'))
    assert sentence == "diagnoses of a starter or a solution need an exercise"


def test_a_question_needs_the_checks_that_answer_it(kitchen: Kitchen) -> None:
    folder = kitchen(WHOLE + COURSE)
    (folder / "checks.py").unlink()
    assert sentence_about(folder) == "there is no file 'checks.py' beside it"


def test_texts_that_are_not_utf8_can_be_shown(kitchen: Kitchen) -> None:
    folder = kitchen(WHOLE)
    (folder / "guide.md").write_bytes(b"# Two cooks\n\nCaf\xe9\n")
    (folder / "explain.md").write_bytes(b"Caf\xe9\n")
    lesson = read_lesson(folder)
    assert (lesson.guide, lesson.explanation) == ("# Two cooks\n\nCaf\ufffd\n", "Caf\ufffd\n")
