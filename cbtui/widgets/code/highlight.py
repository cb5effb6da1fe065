"""Python source as lines of words of a kind, so that a theme can colour them."""

from collections.abc import Iterator
from enum import StrEnum
from typing import NamedTuple

from pygments.lexers.python import PythonLexer
from pygments.token import Token, _TokenType


class Kind(StrEnum):
    """What a word of source is; the value is the component class that styles it."""

    PLAIN = "code--plain"
    KEYWORD = "code--keyword"
    NAME = "code--name"
    BUILTIN = "code--builtin"
    STRING = "code--string"
    NUMBER = "code--number"
    COMMENT = "code--comment"


class Word(NamedTuple):
    """A piece of a line."""

    text: str
    kind: Kind


_KINDS: dict[_TokenType, Kind] = {
    Token.Comment: Kind.COMMENT,
    Token.Keyword: Kind.KEYWORD,
    Token.Operator.Word: Kind.KEYWORD,
    Token.Name.Function: Kind.NAME,
    Token.Name.Class: Kind.NAME,
    Token.Name.Decorator: Kind.NAME,
    Token.Name.Builtin: Kind.BUILTIN,
    Token.Literal.String: Kind.STRING,
    Token.Literal.Number: Kind.NUMBER,
}


def highlight(source: str) -> list[list[Word]]:
    """Return the lines of a Python source; tabs become spaces."""
    lines: list[list[Word]] = [[]]
    for kind, text in _tokens(source):
        first, *others = text.split("\n")
        if first:
            lines[-1].append(Word(first, kind))
        lines += [[Word(other, kind)] if other else [] for other in others]
    while lines and not lines[-1]:
        lines.pop()
    return lines


def _tokens(source: str) -> Iterator[tuple[Kind, str]]:
    lexer = PythonLexer(stripnl=False, tabsize=4)
    for token, text in lexer.get_tokens(source):
        yield _kind_of(token), text


def _kind_of(token: _TokenType) -> Kind:
    kind: _TokenType | None = token
    while kind is not None and kind is not Token:
        if kind in _KINDS:
            return _KINDS[kind]
        kind = kind.parent
    return Kind.PLAIN
