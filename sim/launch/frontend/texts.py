"""Texts of launch files in XML and YAML: ``$(var speed)`` and the like become substitutions."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from typing import Any

from sim.launch.errors import LaunchFailure
from sim.launch.launch import substitutions as launch
from sim.launch.launch.substitution import Substitution, TextSubstitution
from sim.launch.launch_ros import substitutions as ros

Parts = list[Substitution]

_KNOWN: Mapping[str, Callable[..., Any]] = {
    "and": launch.AndSubstitution,
    "any": launch.AnySubstitution,
    "all": launch.AllSubstitution,
    "command": launch.Command,
    "dirname": launch.ThisLaunchFileDir,
    "env": lambda name, default=None: launch.EnvironmentVariable(name, default_value=default),
    "equals": launch.EqualsSubstitution,
    "eval": launch.PythonExpression,
    "exec-in-package": ros.ExecutableInPackage,
    "exec-in-pkg": ros.ExecutableInPackage,
    "file-content": launch.FileContent,
    "filename": launch.ThisLaunchFile,
    "find-exec": lambda name: launch.FindExecutable(name=name),
    "find-pkg": ros.FindPackagePrefix,
    "find-pkg-prefix": ros.FindPackagePrefix,
    "find-pkg-share": ros.FindPackageShare,
    "if": launch.IfElseSubstitution,
    "not": launch.NotSubstitution,
    "not-equals": launch.NotEqualsSubstitution,
    "or": launch.OrSubstitution,
    "param": ros.Parameter,
    "var": lambda name, default=None: launch.LaunchConfiguration(name, default=default),
}


def substitutions(text: str) -> Parts:
    """Split a text into plain parts and substitutions.

    Raises:
        LaunchFailure: a substitution is unknown, is not closed, or has a wrong number of arguments.
    """
    return _TextScanner(text).parts("")


class _TextScanner:
    """Reads a text from left to right."""

    def __init__(self, text: str) -> None:
        self._text = text
        self._at = 0

    def parts(self, ends: str) -> Parts:
        """Read the parts before one of the characters of ``ends``, or before the end of the text."""
        parts: Parts = []
        plain = ""
        while self._at < len(self._text) and self._text[self._at] not in ends:
            if self._text.startswith("$(", self._at):
                parts += [TextSubstitution(text=plain)] if plain else []
                plain = ""
                parts.append(self._substitution())
                continue
            self._at += self._text[self._at] == "\\"
            plain += self._text[self._at : self._at + 1]
            self._at += 1
        return [*parts, TextSubstitution(text=plain)] if plain else parts

    def _substitution(self) -> Substitution:
        begin = self._at
        name = re.compile(r"[^\s)]*").match(self._text, begin + 2)
        assert name is not None
        self._at = name.end()
        arguments: list[Parts] = []
        while self._at < len(self._text):
            here = self._text[self._at]
            if here == ")":
                self._at += 1
                return _made(name[0], arguments)
            if here.isspace():
                self._at += 1
            elif here in "'\"":
                self._at += 1
                arguments.append(self.parts(here))
                self._at += 1
            else:
                arguments.append(self.parts(" \t\n)"))
        raise LaunchFailure(f"the closing bracket of {self._text[begin:]} is missing")


def _made(name: str, arguments: list[Parts]) -> Substitution:
    if name not in _KNOWN:
        raise LaunchFailure(f"there is no substitution $({name} …); there are {', '.join(sorted(_KNOWN))}")
    if name == "eval":
        arguments = [_joined(arguments)]
    try:
        made = _KNOWN[name](*arguments)
    except TypeError:
        raise LaunchFailure(f"$({name} …) does not take {len(arguments)} arguments") from None
    assert isinstance(made, Substitution)
    return made


def _joined(arguments: list[Parts]) -> Parts:
    """Join several arguments by spaces."""
    space = TextSubstitution(text=" ")
    return [part for argument in arguments for part in (space, *argument)][1:]
