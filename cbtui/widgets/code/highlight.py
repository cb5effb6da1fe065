"""Python source as lines of tokens, which a theme can colour."""

from collections.abc import Iterator
from enum import StrEnum
from typing import NamedTuple

from pygments.lexers.python import PythonLexer
from pygments.token import Token, _TokenType


class TokenKind(StrEnum):
    """The kind of a token; the value is its component class."""

    PLAIN = "code--plain"
    KEYWORD = "code--keyword"
    NAME = "code--name"
    BUILTIN = "code--builtin"
    STRING = "code--string"
    NUMBER = "code--number"
    COMMENT = "code--comment"


class SourceToken(NamedTuple):
    """A token of a line."""

    text: str
    kind: TokenKind


_KINDS: dict[_TokenType, TokenKind] = {
    Token.Comment: TokenKind.COMMENT,
    Token.Keyword: TokenKind.KEYWORD,
    Token.Operator.Word: TokenKind.KEYWORD,
    Token.Name.Function: TokenKind.NAME,
    Token.Name.Class: TokenKind.NAME,
    Token.Name.Decorator: TokenKind.NAME,
    Token.Name.Builtin: TokenKind.BUILTIN,
    Token.Literal.String: TokenKind.STRING,
    Token.Literal.Number: TokenKind.NUMBER,
}


def highlight(source: str) -> list[list[SourceToken]]:
    """Return the lines of a Python source; tabs become spaces."""
    lines: list[list[SourceToken]] = [[]]
    for kind, text in _tokens(source):
        first, *others = text.split("\n")
        if first:
            lines[-1].append(SourceToken(first, kind))
        lines += [[SourceToken(other, kind)] if other else [] for other in others]
    while lines and not lines[-1]:
        lines.pop()
    return lines


def _tokens(source: str) -> Iterator[tuple[TokenKind, str]]:
    lexer = PythonLexer(stripnl=False, tabsize=4)
    for token, text in lexer.get_tokens(source):
        yield _kind_of(token), text


def _kind_of(token: _TokenType) -> TokenKind:
    kind: _TokenType | None = token
    while kind is not None and kind is not Token:
        if kind in _KINDS:
            return _KINDS[kind]
        kind = kind.parent
    return TokenKind.PLAIN
