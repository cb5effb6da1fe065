"""Splitting lines into words, as a shell does."""

import shlex

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from sim.shell.quoting import quoted
from sim.shell.splitting import LineError, scan, split

_SHELL_TEXT = st.text(st.sampled_from("ab \t\n'\"\\${}:#-;|&>é`"), max_size=24)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (
            "ros2 service call /dummy_server_srv std_srvs/srv/SetBool data:\\ false",
            ["service", "call", "/dummy_server_srv", "std_srvs/srv/SetBool", "data: false"],
        ),
        (
            "ros2 service call /dummy_server_srv std_srvs/srv/SetBool data:\\ false\\",
            ["service", "call", "/dummy_server_srv", "std_srvs/srv/SetBool", "data: false"],
        ),
        ('ros2 topic pub /t a/B "x: 0.0\n  y: 1\n"', ["topic", "pub", "/t", "a/B", "x: 0.0\n  y: 1\n"]),
        ("topic list", ["topic", "list"]),
        ("$ ros2 topic list", ["topic", "list"]),
        ("user:~/ros2_ws$ ros2 node list # all of them", ["node", "list"]),
        ("topic \\\n  list", ["topic", "list"]),
        ("topic echo ''", ["topic", "echo", ""]),
        ("run a b 'it'\"'\"'s'", ["run", "a", "b", "it's"]),
        ("", []),
        ("ros2", []),
        ("bag record", ["bag", "record"]),
    ],
)
def test_words_are_those_of_a_shell_without_prompt_and_ros2(text: str, words: list[str]) -> None:
    assert split(text) == words


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ('ros2 topic pub /t a/B "x: 1', 'a quote is not closed: there is no second " in the line'),
        ("topic list | grep x", "put | in quotes"),
        ("topic list\nnode list", "put the second line in quotes"),
        ("cd ~/ros2_ws", "cd: command not found; known here is ros2 with action, interface, launch"),
    ],
)
def test_what_cannot_be_read_is_said_in_one_sentence(text: str, sentence: str) -> None:
    with pytest.raises(LineError) as raised:
        split(text)
    assert sentence in str(raised.value)
    assert "\n" not in str(raised.value)


@given(st.text() | _SHELL_TEXT)
@example("\\")
@example('"\\')
def test_splitting_raises_nothing_but_its_own_error(text: str) -> None:
    try:
        split(text)
    except LineError as error:
        assert str(error)  # noqa: PT017 -- either way is right


@given(st.text(st.sampled_from("ab \t'\"\\{}:-é"), max_size=24))
def test_words_in_quotes_are_those_of_the_standard_library(text: str) -> None:
    try:
        expected = shlex.split(text)
    except ValueError:
        return
    assert [word.text for word in scan(text).words] == expected


@given(st.text(max_size=20))
def test_a_quoted_word_is_read_back(text: str) -> None:
    (word,) = scan(f" {quoted(text)}").words
    assert word.text == (text if "\n" in text.removesuffix("\n") else text.removesuffix("\n"))
