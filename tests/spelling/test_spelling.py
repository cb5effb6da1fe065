"""What people read is spelt right, in British English; the course's own words are in `words.txt`."""

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator
from functools import cache
from importlib.resources import files
from pathlib import Path

import pytest
from spellchecker import SpellChecker

from tests.spelling.texts import lesson_texts, program_texts, readme_texts, words_in

OWN_WORDS = set((Path(__file__).parent / "words.txt").read_text(encoding="utf-8").split())
"""Names, the field's terms, and what Python calls things."""
NOT_AMERICAN = {"program", "math"}
"""Words that are British as well where computers are spoken of."""
QUOTED = {
    "canceled",
    "finalized",
    "initialize",
    "initialized",
    "license",
    "randomized",
    "recognized",
    "utilization",
} | {
    "color",
    "serialized",
    "unrecognized",
}
"""As ROS, a library or the title of a paper has them."""

WRONG = "rezeives"

Texts = Callable[[], Iterable[tuple[str, str]]]

every_text = pytest.mark.parametrize("texts", [lesson_texts, program_texts, readme_texts])


def british_for() -> dict[str, str]:
    """American spellings, each with the British one."""
    table = files("codespell_lib").joinpath("data", "dictionary_en-GB_to_en-US.txt")
    pairs = (line.split("->") for line in table.read_text(encoding="utf-8").splitlines())
    return {american.strip(" ,"): british for british, american in pairs}


@cache
def places_of(texts: Texts) -> dict[str, list[str]]:
    """Every word that is read, with where it stands."""
    places: defaultdict[str, list[str]] = defaultdict(list)
    for place, text in texts():
        for word in words_in(text):
            places[word.lower()].append(place)
    return places


def told(words: Iterable[str], places: dict[str, list[str]]) -> Iterator[str]:
    """Each word with where it stands first."""
    for word in sorted(words):
        yield f"{places[word][0]}: {word}"


@every_text
def test_every_word_is_in_the_dictionary_or_is_one_of_the_course(texts: Texts) -> None:
    places = places_of(texts)
    unknown = SpellChecker().unknown(places) - OWN_WORDS - set(british_for().values())
    assert list(told(unknown, places)) == []


@every_text
def test_there_is_one_english_and_it_is_british(texts: Texts) -> None:
    places = places_of(texts)
    american = places.keys() & british_for().keys() - NOT_AMERICAN - QUOTED
    assert list(told(american, places)) == []


def test_a_word_that_is_spelt_wrong_is_found() -> None:
    places = places_of(lambda: [("guide.md", f"A callback `{WRONG}` what it {WRONG}; its color is gray.")])
    assert SpellChecker().unknown(places) - OWN_WORDS == {WRONG}
    assert {"color", "gray"} <= places.keys() & british_for().keys()


def test_the_own_words_stand_in_order_and_are_in_no_dictionary() -> None:
    words = (Path(__file__).parent / "words.txt").read_text(encoding="utf-8").split()
    assert words == sorted(set(words))
    assert SpellChecker().unknown(words) == set(words)
