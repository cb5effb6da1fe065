"""Splits a line into words as a POSIX shell does.

Rules: POSIX.1-2017, Shell Command Language, sections 2.2 (quoting) and 2.3 (token recognition).
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from sim.shell.command_names import COMMANDS, ELSEWHERE, listed

_PROMPT = re.compile(r"\s*(?:\S*\$\s+)?")
_OPERATORS = frozenset(";|&<>()")
_ESCAPED_IN_DOUBLE_QUOTES = frozenset('$`"\\')
_UNREADABLE, _NO_COMMAND = 2, 127


class LineError(ValueError):
    """A line cannot be carried out; the text says why, ``status`` is a shell's exit status."""

    def __init__(self, text: str, status: int = _UNREADABLE) -> None:
        super().__init__(text)
        self.status = status


@dataclass(slots=True)
class ShellWord:
    """A word without its quotes, and its start in the line."""

    text: str
    start: int


@dataclass(slots=True)
class Scan:
    """The parts of a line: its words, an open quote, and the first operator; "" for none."""

    words: list[ShellWord] = field(default_factory=list)
    quote: str = ""
    operator: str = ""
    ends_in_word: bool = False


def split(text: str) -> list[str]:
    """Return the words of a line after ``ros2``; a ``$`` prompt before that is skipped.

    A backslash at the end, after which a shell would wait for another line, is ignored.

    Raises:
        LineError: a quote is not closed, the line has several commands, or the command is not ``ros2``.
    """
    scanned = scan(text)
    if scanned.quote:
        raise LineError(f"a quote is not closed: there is no second {scanned.quote} in the line")
    if scanned.operator:
        raise LineError(
            f"one command at a time is carried out here: put {_shown(scanned.operator)} in quotes "
            "if it belongs to a value"
        )
    words = [word.text for word in scanned.words]
    if words[:1] == ["ros2"]:
        return words[1:]
    if words and words[0] not in (*COMMANDS, *ELSEWHERE):
        raise LineError(f"{words[0]}: command not found; known here is ros2 with {listed()}", _NO_COMMAND)
    return words


def scan(text: str) -> Scan:
    """Scan a line, complete or not."""
    prompt = _PROMPT.match(text)
    assert prompt is not None
    return _LineScanner(text, prompt.end()).run()


def _shown(operator: str) -> str:
    return "the second line" if operator == "\n" else operator


class _LineScanner:
    """Reads a line character by character."""

    def __init__(self, text: str, start: int) -> None:
        self._text = text
        self._at = start
        self._found = Scan()
        self._word: ShellWord | None = None
        self._after_line_end = False

    def run(self) -> Scan:
        while self._at < len(self._text):
            self._read(self._text[self._at])
        self._found.ends_in_word = self._word is not None
        self._end_word()
        return self._found

    def _read(self, character: str) -> None:
        if character.isspace():
            self._end_word()
            self._after_line_end |= character == "\n" and bool(self._found.words)
            self._at += 1
        elif character == "#" and self._word is None:
            end = self._text.find("\n", self._at)
            self._at = len(self._text) if end < 0 else end
        elif character in "'\"":
            self._read_quoted(character)
        elif character == "\\":
            self._read_escaped()
        else:
            if character in _OPERATORS:
                self._operator(character)
            self._append(character, 1)

    def _read_escaped(self) -> None:
        following = self._text[self._at + 1 : self._at + 2]
        if following in ("", "\n"):
            self._at += 2
        else:
            self._append(following, 2)

    def _read_quoted(self, quote: str) -> None:
        self._append("", 1)
        while (character := self._text[self._at : self._at + 1]) != quote:
            if not character:
                self._found.quote = quote
                return
            following = self._text[self._at + 1 : self._at + 2]
            if quote == '"' and character == "\\" and following == "\n":
                self._at += 2
            elif quote == '"' and character == "\\" and following in _ESCAPED_IN_DOUBLE_QUOTES and following:
                self._append(following, 2)
            else:
                self._append(character, 1)
        self._at += 1

    def _append(self, text: str, length: int) -> None:
        if self._word is None:
            self._word = ShellWord("", self._at)
            if self._after_line_end:
                self._operator("\n")
        self._word.text += text
        self._at += length

    def _operator(self, operator: str) -> None:
        self._found.operator = self._found.operator or operator

    def _end_word(self) -> None:
        if self._word is not None:
            self._found.words.append(self._word)
            self._word = None
