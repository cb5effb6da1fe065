"""The words that people read: of lessons, and of everything that the console and the engine say."""

import ast
import io
import re
import tokenize
import tomllib
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[2]
LESSONS = ROOT / "lessons"
PROGRAM = (ROOT / "cbtui", ROOT / "sim", LESSONS)

_CODE = re.compile(r"```.*?```|`+[^`]*`+", re.DOTALL)
_LINK = re.compile(r"\]\([^)]*\)|https?://\S+")
_NOT_PROSE = re.compile(
    r"\S*[_/\\{}\[\]=<>@#$%^|~0-9]\S*"  # paths, formats, operators, numbers
    r"|\S+\.\S+|\S+\(\S*|(?<!\S)[-.]\S+"  # names with dots, calls, options, file endings
    r"|\S*[a-z][A-Z]\S*|\b[A-Z][A-Z]+\w*"  # CamelCase and abbreviations
)
_WORD = re.compile(r"[A-Za-zÀ-ÿ]+(?:'[A-Za-z]+)?")
_SENTENCE = re.compile(r"[a-z]{2,}\W+[a-z]{2,}\W+[a-z]+")
"""What a string has in it that a person reads, and that is no identifier, key or format."""


def words_in(text: str) -> Iterator[str]:
    """The words of a text; what is code, a name, a number, a path or an abbreviation is none."""
    for word in _WORD.findall(_NOT_PROSE.sub(" ", _LINK.sub(" ", _CODE.sub(" ", text)))):
        yield word.removesuffix("'s")


def lesson_texts() -> Iterator[tuple[str, str]]:
    """Each text of the lessons, with where it stands, comments in their nodes among them."""
    for path in sorted(LESSONS.rglob("*.md")):
        yield _named(path), path.read_text(encoding="utf-8")
    for path in sorted(LESSONS.rglob("lesson.toml")):
        for text in _strings(tomllib.loads(path.read_text(encoding="utf-8"))):
            yield _named(path), text
    for path in sorted(LESSONS.rglob("*.py")):
        yield from _comments(path)


def program_texts() -> Iterator[tuple[str, str]]:
    """Each sentence in the source of the program, its docstrings among them, with where it stands."""
    for folder in PROGRAM:
        for path in sorted(folder.rglob("*.py")):
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                match node:
                    case ast.Constant(value=str(text)) if _SENTENCE.search(text):
                        yield f"{_named(path)}:{node.lineno}", text


def readme_texts() -> Iterator[tuple[str, str]]:
    """The README."""
    for name in ("README.md", *(f"{room}/README.md" for room in ("cbtui", "lessons", "sim", "tests"))):
        yield name, (ROOT / name).read_text(encoding="utf-8")


def _comments(path: Path) -> Iterator[tuple[str, str]]:
    source = path.read_text(encoding="utf-8")
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.COMMENT:
            yield f"{_named(path)}:{token.start[0]}", token.string


def _strings(value: object) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict):
        for each in value.values():
            yield from _strings(each)
    elif isinstance(value, list):
        for each in value:
            yield from _strings(each)


def _named(path: Path) -> str:
    return str(path.relative_to(ROOT))
