"""A lesson: the typed description that a `lesson.toml` gives, and the files beside it."""

import re
import tomllib
from pathlib import Path
from typing import Annotated, Any

import msgspec
from msgspec import Meta, Struct, structs

DESCRIPTION_FILE = "lesson.toml"
GUIDE_FILE = "guide.md"

Text = Annotated[str, Meta(min_length=1)]
LessonId = Annotated[str, Meta(pattern=r"^[a-z0-9]+(-[a-z0-9]+)*$")]
Number = Annotated[int, Meta(ge=1)]
PythonFile = Annotated[str, Meta(pattern=r"^\w+\.py$")]
ServiceName = Annotated[str, Meta(pattern=r"^(/[A-Za-z_]\w*)+$")]
ServiceType = Annotated[str, Meta(pattern=r"^[a-z]\w*/srv/[A-Z]\w*$")]


class BadLesson(ValueError):  # noqa: N818 - the sentence it carries is what a reader sees
    """A lesson's folder cannot be used; the text is one sentence naming the file, the field and the fault."""


class Setup(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Which node a lesson runs, and how it is started."""

    node: PythonFile
    """File name of the node, in the lesson's folder."""
    arguments: tuple[str, ...] = ()
    """Command line of the node, without the program's name."""
    threads_argument: Text | None = None
    """The argument that carries the number of threads; None when the node fixes its executor itself."""

    def __post_init__(self) -> None:
        if self.arguments and self.arguments[-1] == self.threads_argument:
            raise ValueError(f"{self.threads_argument} stands last in arguments and has no number after it")


class Service(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The service that a lesson's `s` key calls."""

    name: ServiceName
    type: ServiceType


class Try(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One thing a learner is invited to do: the key to press and what to look for."""

    key: Text
    text: Text


class Description(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Everything a `lesson.toml` says."""

    id: LessonId
    """Name of the lesson on the command line; the lesson's folder has the same name."""
    number: Number
    """Place in the teaching order."""
    unit: Text
    title: Text
    teaches: Text
    executor: Text
    """The executor as the menu shows it."""
    groups: Text
    """The callback groups as the menu shows them."""
    setup: Setup
    service: Service
    tries: tuple[Try, ...] = msgspec.field(name="try", default=())


class Lesson(Description, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A lesson and the folder it lives in."""

    folder: Path

    @property
    def node_path(self) -> Path:
        """The node's source file."""
        return self.folder / self.setup.node

    @property
    def guide(self) -> str:
        """The Markdown text that goes with the lesson."""
        return (self.folder / GUIDE_FILE).read_text(encoding="utf-8")

    def arguments_with(self, threads: int | None) -> list[str]:
        """Return the node's command line with its number of threads replaced.

        None keeps the lesson's own number. A node without such an argument gets its usual command
        line; its executor has to be changed by whoever runs it.
        """
        arguments = list(self.setup.arguments)
        name = self.setup.threads_argument
        if threads is None or name is None:
            return arguments
        if name not in arguments:
            return [*arguments, name, str(threads)]
        arguments[arguments.index(name) + 1] = str(threads)
        return arguments


def read_lesson(folder: Path) -> Lesson:
    """Read the lesson in a folder.

    Raises BadLesson when `lesson.toml` is missing, is not TOML or does not describe a lesson, when
    its id is not the folder's name, or when the node or the guide is missing.
    """
    path = folder / DESCRIPTION_FILE
    try:
        description = msgspec.convert(_table(path), Description)
    except msgspec.ValidationError as error:
        raise BadLesson(f"{path}: {_fault(str(error))}") from error
    if description.id != folder.name:
        raise BadLesson(f"{path}: the field 'id' is wrong: {description.id!r} is not the name of its folder")
    for field, file in (("setup.node", description.setup.node), (None, GUIDE_FILE)):
        if not (folder / file).is_file():
            wanted_by = f"the field {field!r} is wrong: " if field else ""
            raise BadLesson(f"{path}: {wanted_by}there is no file {file!r} beside it")
    return Lesson(**structs.asdict(description), folder=folder)


def _table(path: Path) -> dict[str, Any]:
    try:
        with path.open("rb") as file:
            return tomllib.load(file)
    except OSError as error:
        raise BadLesson(f"{path}: cannot be read: {error.strerror}") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise BadLesson(f"{path}: is not valid TOML: {error}") from error


_ERROR = re.compile(r"(?P<what>.*?)(?: - at `\$\.?(?P<where>.*)`)?", re.DOTALL)
_FIELD_ERROR = re.compile(r"Object (?P<kind>missing required|contains unknown) field `(?P<field>.*)`")


def _fault(error: str) -> str:
    """Say msgspec's complaint (`Expected …, got … - at `$.setup.node``) as the end of a sentence."""
    parts = _ERROR.fullmatch(error)
    assert parts is not None, "the pattern matches every text"
    what, where = parts["what"], parts["where"]
    if about_field := _FIELD_ERROR.fullmatch(what):
        field = ".".join(filter(None, (where, about_field["field"])))
        missing = about_field["kind"] == "missing required"
        return f"the field {field!r} is " + ("missing" if missing else "not known")
    return f"the field {where!r} is wrong: {what[:1].lower()}{what[1:]}"
