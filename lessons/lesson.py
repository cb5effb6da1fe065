"""A lesson: the description in its `lesson.toml`, and the files beside that."""

import os
import re
from collections.abc import Iterator
from itertools import islice
from pathlib import Path

import msgspec
from msgspec import structs

from lessons.description import Description, Setting, Try, number_after, with_argument
from sim.files import plain_toml, untrusted

__all__ = ["BadLesson", "Lesson", "Setting", "Try", "number_after", "read_lesson", "with_argument"]

DESCRIPTION_FILE = "lesson.toml"
GUIDE_FILE = "guide.md"
EXPLANATION_FILE = "explain.md"
CHECKS_FILE = "checks.py"


class BadLesson(ValueError):  # noqa: N818 - the sentence it carries is what a reader sees
    """A lesson's folder cannot be used; the text is one sentence naming the file, the field and the fault."""


class Lesson(Description, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A lesson and the folder it lives in."""

    folder: Path
    following: str = ""
    """Title and teaser of the next lesson, in Markdown; the catalogue, which knows the order, fills it in."""

    @property
    def node_path(self) -> Path:
        """The node's source file."""
        return Path(os.path.normpath(self.folder / self.setup.node))

    @property
    def guide(self) -> str:
        """The Markdown text of the guide; bytes that are not UTF-8 are replaced."""
        return untrusted.read_text(self.folder / GUIDE_FILE, errors="replace")

    @property
    def explanation(self) -> str:
        """The Markdown text to be read after the run, as ``guide``; empty if there is none."""
        path = self.folder / EXPLANATION_FILE
        return untrusted.read_text(path, errors="replace") if path.is_file() else ""

    @property
    def checks_path(self) -> Path:
        """The file with checks and answers; every lesson with predictions or an exercise has one."""
        return self.folder / CHECKS_FILE

    @property
    def starter_path(self) -> Path | None:
        """The file that a learner begins the exercise with; None without an exercise."""
        return None if self.exercise is None else self.folder / self.exercise.starter

    @property
    def solution_path(self) -> Path | None:
        """A file that does what the exercise asks; None without an exercise."""
        return None if self.exercise is None else self.folder / self.exercise.solution

    @property
    def file_name(self) -> str:
        """The name of a learner's own file for the exercise: `split_groups.py`."""
        return f"{self.id.replace('-', '_')}.py"

    def arguments_with(self, threads: int | None) -> list[str]:
        """Return the node's command line with its number of threads replaced.

        None keeps the lesson's own number. A node without such an argument gets its usual command
        line; the caller has to change its executor.
        """
        arguments = list(self.setup.arguments)
        name = self.setup.threads_argument
        if threads is None or name is None:
            return arguments
        return with_argument(arguments, name, str(threads))


def read_lesson(folder: Path) -> Lesson:
    """Read the lesson in a folder.

    Raises BadLesson when `lesson.toml` is missing, is not TOML or does not describe a lesson, when
    its id is not the folder's name, or when a file that it needs is missing.
    """
    path = folder / DESCRIPTION_FILE
    text = _text(path)
    try:
        description = msgspec.convert(plain_toml.load(text), Description)
    except msgspec.ValidationError as error:
        fault, field = _fault(str(error))
        raise BadLesson(f"{_place(path, text, field)}: {fault}") from error
    except ValueError as error:  # errors of the parser, and of its conversion of numbers and texts
        what, line = _SYNTAX_ERROR.findall(str(error))[0]
        raise BadLesson(f"{path}{f':{line}' if line else ''}: is not valid TOML: {what}") from error
    if description.id != folder.name:
        fault = f"the field 'id' is wrong: {description.id!r} is not the name of its folder"
        raise BadLesson(f"{_place(path, text, 'id')}: {fault}")
    for field, file in _files_of(description):
        if not (folder / file).is_file():
            wanted_by = f"the field {field!r} is wrong: " if field else ""
            raise BadLesson(f"{_place(path, text, field)}: {wanted_by}there is no file {file!r} beside it")
    return Lesson(**structs.asdict(description), folder=folder)


def _files_of(description: Description) -> Iterator[tuple[str, str]]:
    """Yield the required files, each with the field that names it, if one does."""
    yield "setup.node", description.setup.node
    yield "", GUIDE_FILE
    if description.exercise is not None:
        yield "exercise.starter", description.exercise.starter
        yield "exercise.solution", description.exercise.solution
    if description.exercise is not None or description.predictions:
        yield "", CHECKS_FILE


def _text(path: Path) -> str:
    try:
        return untrusted.read_text(path)
    except OSError as error:
        raise BadLesson(f"{path}: cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise BadLesson(f"{path}:{untrusted.decoding_fault(error)}") from error


_SYNTAX_ERROR = re.compile(r"(.*?)(?: \(at line (\d+), .*\))?\Z", re.DOTALL)
_ERROR = re.compile(r"(?P<what>.*?)(?: - at `\$\.?(?P<where>.*)`)?", re.DOTALL)
_FIELD_ERROR = re.compile(r"Object (?P<kind>missing required|contains unknown) field `(?P<field>.*)`")


def _fault(error: str) -> tuple[str, str]:
    """Turn an error of msgspec (`Expected …, got … - at `$.setup.node``) into the end of a sentence.

    The second text is the field that it is about, or for a missing one the table that lacks it.
    """
    parts = _ERROR.fullmatch(error)
    assert parts is not None, "the pattern matches every text"
    what, where = parts["what"], parts["where"] or ""
    if about_field := _FIELD_ERROR.fullmatch(what):
        field = ".".join(filter(None, (where, about_field["field"])))
        if about_field["kind"] == "missing required":
            return f"the field {field!r} is missing", where
        return f"the field {field!r} is not known", field
    return f"the field {where!r} is wrong: {what[:1].lower()}{what[1:]}" if where else what, where


def _place(path: Path, text: str, field: str) -> str:
    """Return the file, with the line of a field such as `try[1].text` where it has one of its own."""
    end = 0
    for name, place in re.findall(r"([\w-]+)(?:\[(\d+)\])?", field):
        named = re.compile(rf"^[ \t]*(?:{name}\b|\[+[\w.-]*\b{name}\])", re.MULTILINE)
        found = list(islice(named.finditer(text, end), int(place or 0) + 1))
        end = found[-1].end() if found else end
    return f"{path}:{text.count(chr(10), 0, end) + 1}" if end else str(path)
