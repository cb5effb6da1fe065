"""Candidates for the word at the cursor."""

from __future__ import annotations

import argparse

from sim.interfaces import DefinitionError
from sim.packages import PackageError, Packages
from sim.shell.commands import next_names, verb_parser
from sim.shell.ground import Ground
from sim.shell.parser import LineParser, Surroundings
from sim.shell.session import CommandFailed
from sim.shell.splitting import scan

_MANY = (argparse.ONE_OR_MORE, argparse.ZERO_OR_MORE, argparse.REMAINDER)


def word_start(text: str, cursor: int) -> int:
    """Return the start of the word at the cursor; the cursor itself if there is no word."""
    scanned = scan(text[:cursor])
    return scanned.words[-1].start if scanned.ends_in_word else cursor


def complete(ground: Ground, packages: Packages, text: str, cursor: int) -> list[str]:
    """Return candidates for the text from ``word_start`` to the cursor, quoted for a shell.

    Reads the current graph, without waiting. Thread-safe on the real clock; on
    virtual time, call it on a thread of the run.
    """
    scanned = scan(text[:cursor])
    words = [word.text for word in scanned.words]
    begun = words.pop() if scanned.ends_in_word else ""
    has_ros2 = words[:1] == ["ros2"]
    words = words[has_ros2:]
    found = verb_parser(words)
    if found is None:
        names = next_names(words)
        if not words and not has_ros2:
            names = ["ros2", *names]
        return [name for name in names if name.startswith(begun)]
    parser, used = found
    candidates = _CursorPosition(parser, words[used:]).candidates(begun, ground, packages)
    return [each for each in candidates if _unquoted(each).startswith(begun)]


class _CursorPosition:
    """The position of the cursor in a verb's arguments, after some words."""

    def __init__(self, parser: LineParser, words: list[str]) -> None:
        self._parser = parser
        self._given: list[str] = []
        self._awaited: argparse.Action | None = None
        """The option whose value comes next."""
        for word in words:
            self._take(word)

    def candidates(self, begun: str, ground: Ground, packages: Packages) -> list[str]:
        action = self._awaited or self._next_positional()
        if self._awaited is None and begun.startswith("-") and not _takes_anything(action):
            return sorted(each for each in self._parser._option_string_actions if each.startswith("--"))
        if action is not None and action.choices is not None:
            return sorted(map(str, action.choices))
        completer = None if action is None else self._parser.completers.get(action)
        if completer is None:
            return []
        try:
            return sorted(set(completer(Surroundings(ground, packages, tuple(self._given)))))
        except (CommandFailed, PackageError, DefinitionError):  # an earlier argument is unknown
            return []

    def _take(self, word: str) -> None:
        if self._awaited is not None:
            self._awaited = None
        elif word.startswith("-") and (option := self._parser._option_string_actions.get(word)) is not None:
            self._awaited = None if option.nargs == 0 else option
        elif not word.startswith("--"):
            self._given.append(word)

    def _next_positional(self) -> argparse.Action | None:
        positionals = self._parser._get_positional_actions()
        if len(self._given) < len(positionals):
            return positionals[len(self._given)]
        return positionals[-1] if positionals and positionals[-1].nargs in _MANY else None


def _unquoted(word: str) -> str:
    return "".join(each.text for each in scan(word).words)


def _takes_anything(action: argparse.Action | None) -> bool:
    return action is not None and action.nargs == argparse.REMAINDER
