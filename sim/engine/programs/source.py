"""Reads a learner's file as Python does, and explains why it cannot be run."""

import ast
import importlib.util
import linecache
from collections.abc import Callable, Mapping
from pathlib import Path
from types import CodeType

from sim.files.untrusted import MAX_PROGRAM_BYTES, decoding_fault, read_bytes


class NothingToRunError(Exception):
    """A file cannot be run as a program; the text says why and what to do."""


edited: dict[str, str] = {}
"""Texts that run in place of what files hold, by path."""
changes: list[Callable[[ast.Module, str, str], ast.Module]] = []
"""Functions that change a program's syntax tree before it is compiled; they get its text and file name."""


def compiled(text: str, file: str) -> CodeType:
    """Compile a program; a syntax error is raised as by Python."""
    if not changes:
        return compile(text, file, "exec", dont_inherit=True)
    tree = ast.parse(text, file)
    for change in changes:
        tree = change(tree, text, file)
    return compile(tree, file, "exec", dont_inherit=True)


def run_edited(texts: Mapping[str, str]) -> None:
    """Have texts run in place of what files hold, by path; tracebacks show their lines."""
    edited.update(texts)
    for path, text in texts.items():
        linecache.cache[path] = (len(text), None, text.splitlines(keepends=True), path)


def read_source(path: Path) -> str:
    """Return the text of a program's file, decoded as by Python.

    Raises:
        NothingToRunError: the file cannot be read or is not text.
    """
    try:
        data = read_bytes(path, MAX_PROGRAM_BYTES)
    except OSError as error:
        raise NothingToRunError(f"{path.name} cannot be read: {error.strerror}") from None
    if b"\0" in data:
        raise NothingToRunError(f"{path.name} is not a Python file: it has null bytes in it")
    try:
        return importlib.util.decode_source(data)
    except UnicodeDecodeError as error:
        raise NothingToRunError(_on_undecodable(path.name, error)) from None
    except SyntaxError as error:
        try:
            data.decode()
        except UnicodeDecodeError as undecodable:
            raise NothingToRunError(_on_undecodable(path.name, undecodable)) from None
        raise NothingToRunError(f"{path.name}:1: {error.msg}; name a coding that Python knows") from None


def _on_undecodable(name: str, error: UnicodeDecodeError) -> str:
    coding = "name its coding in its first line, such as # -*- coding: latin-1 -*-"
    return f"{name}:{decoding_fault(error)}, or {coding}"
