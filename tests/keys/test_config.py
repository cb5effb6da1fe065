"""The configuration file: what is right in it counts, what is wrong is told with its line."""

from pathlib import Path

import pytest

from cbtui.keys.action import key_id
from cbtui.keys.actions import ACTIONS
from cbtui.keys.config import read_file, read_text
from cbtui.keys.keymap import Keymap, keys_of


def keys(keymap: Keymap, name: str) -> tuple[str, ...]:
    [action] = keymap.of(action for action in ACTIONS if key_id(action) == name)
    return keys_of(action)


@pytest.mark.parametrize(
    "text",
    [
        '[keys]\nlesson.step = ["f5", "!"]',
        '[keys.lesson]\nstep = ["F5", "exclamation_mark"]',
        '[keys]\n"lesson.step" = ["f5", "!"]',
        'keys = { lesson.step = ["f5", "!"] }',
    ],
)
def test_keys_can_be_written_in_every_way_that_toml_has(text: str) -> None:
    config, complaints = read_text(text, "config.toml")
    assert complaints == []
    assert keys(config.keymap, "lesson.step") == ("f5", "!")
    assert keys(config.keymap, "lesson.earlier") == ("[",)


def test_a_comma_can_be_a_key() -> None:
    config, complaints = read_text('[keys]\nlesson.step_back = "f6"\nlesson.step = ","', "config.toml")
    assert complaints == []
    assert keys(config.keymap, "lesson.step") == (",",)
    assert config.keymap.for_textual()["lesson.step"] == "comma"


def test_two_actions_can_swap_their_keys() -> None:
    config, complaints = read_text('[keys]\nlesson.earlier = "]"\nlesson.later = "["', "config.toml")
    assert complaints == []
    assert keys(config.keymap, "lesson.earlier") == ("]",)


def test_what_may_share_a_key_may_share_another() -> None:
    _, complaints = read_text('[keys]\nlesson.pause = "f5"\nlesson.resume = "f5"', "config.toml")
    assert complaints == []


WRONG = {
    "lesson.puase = 'p'": "there is no action lesson.puase; did you mean lesson.pause?",
    "zzz = 'p'": "there is no action zzz; cbtui keys lists them",
    "lesson.pause = 'spcae'": "'spcae' is not the name of a key; did you mean 'space'?",
    "lesson.pause = ''": "'' is not the name of a key; write a character, or a name such as 'space' or 'f5'",
    "lesson.pause = 3": "lesson.pause has to be a key, or a list of keys, each in quotation marks",
    "lesson.pause = []": "lesson.pause has to be a key, or a list of keys, each in quotation marks",
    "lesson.pause = ['p', 3]": "lesson.pause has to be a key, or a list of keys, each in quotation marks",
    "lesson.pause = 'n'": "lesson.pause and lesson.next_lesson would both be n; give one of them another key",
    "lesson.pause = '?'": "lesson.pause and everywhere.help would both be ?; give one of them another key",
    "lesson.pause = 'ctrl+i'": "terminals keep ctrl+i for tab; choose another key for lesson.pause",
    "lesson.pause = 'ctrl+q'": "ctrl+q always leaves the console; choose another key for lesson.pause",
    "lesson.pause = 'alt+p'": "'alt+p' is not the name of a key",
    "lesson.pause = 'up'": "'up' belongs to the panes; choose another key for lesson.pause",
    "prompt.submit = 'p'": "'p' is typed where prompt.submit works; choose a key such as 'f5'",
    "moment.go = '1'": "'1' is typed where moment.go works; choose a key such as 'f5'",
}


@pytest.mark.parametrize(("entry", "sentence"), WRONG.items(), ids=WRONG)
def test_a_wrong_key_is_told_with_its_line_and_the_others_count(entry: str, sentence: str) -> None:
    text = f"# mine\n\n[keys]\nlesson.zoom_in = 'f7'\n{entry}\nlesson.zoom_out = 'f8'\n"
    config, complaints = read_text(text, "config.toml")
    [complaint] = complaints
    assert complaint.startswith(f"config.toml:5: {sentence}")
    assert keys(config.keymap, "lesson.zoom_in") == ("f7",)
    assert keys(config.keymap, "lesson.zoom_out") == ("f8",)
    assert keys(config.keymap, "lesson.pause") == ("space",)
    assert keys(config.keymap, "prompt.submit") == ("enter",)


def test_of_two_that_clash_the_later_one_is_wrong() -> None:
    config, complaints = read_text('[keys]\nlesson.zoom_in = "f7"\nlesson.zoom_out = "f7"', "config.toml")
    assert complaints == [
        "config.toml:3: lesson.zoom_out and lesson.zoom_in would both be f7; give one of them another key"
    ]
    assert keys(config.keymap, "lesson.zoom_in") == ("f7",)
    assert keys(config.keymap, "lesson.zoom_out") == ("<",)


def test_an_entry_whose_partner_in_a_swap_is_wrong_does_not_count_either() -> None:
    text = '[keys]\nlesson.earlier = "]"\nlesson.later = "nonsense"'
    config, complaints = read_text(text, "config.toml")
    assert len(complaints) == 2
    assert config.keymap.for_textual() == {}


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("[display]\ntheme = 'drak'", "c.toml:2: there is no theme 'drak'; did you mean 'dark'?"),
        (
            "[display]\ncharset = 'emoji'",
            "c.toml:2: there is no charset 'emoji'; choose auto, braille, block or",
        ),
        ("[display]\ntheme = 1", "c.toml:2: theme has to be a name in quotation marks"),
        (
            "[display]\ncolour = 1",
            "c.toml:2: there is no entry colour in [display]; there are theme and charset and screen_reader",
        ),
        ("[keyz]\na = 1", "c.toml:1: there is no table [keyz]; did you mean keys?"),
        ("keys = 1", "c.toml:1: keys has to be a table; write [keys], and its entries below"),
        ("[keys]\nlesson.pause =\n", "c.toml:2: invalid value"),
        ("[keys\n", "c.toml:1: expected ']' at the end of a table declaration"),
        ("[keys]\nlesson.pause = [\n", "c.toml:2: invalid value at the end of the file"),
        ("[keys]\nlesson.pause = 'p'\nlesson.pause = 'f5'\n", "c.toml:3: cannot overwrite a value"),
    ],
)
def test_what_else_is_wrong_is_told_in_one_sentence(text: str, complaint: str) -> None:
    [told] = read_text(text, "c.toml").complaints
    assert told.startswith(complaint)
    assert "\n" not in told


def test_complaints_come_in_the_order_of_their_lines() -> None:
    text = "[keys]\nlesson.step = 1\n[display]\ntheme = 1\n[other]\n"
    lines = [complaint.split(":")[1] for complaint in read_text(text, "config.toml").complaints]
    assert lines == ["2", "4", "5"]


def test_a_file_that_cannot_be_read_is_told(tmp_path: Path) -> None:
    (tmp_path / "latin.toml").write_bytes(b"# \xe9t\xe9\n")
    assert read_file(tmp_path / "latin.toml").complaints == [f"{tmp_path / 'latin.toml'} is not UTF-8 text"]
    assert "cannot be read: No such file" in read_file(tmp_path / "none.toml").complaints[0]
    assert "cannot be read: Is a directory" in read_file(tmp_path).complaints[0]


def test_looks_are_taken_over() -> None:
    config, complaints = read_text('[display]\ntheme = "nord"\ncharset = "block"', "config.toml")
    assert (config.theme, config.charset, complaints) == ("nord", "block", [])
