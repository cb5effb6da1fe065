"""Writes each unit of lessons as a ROS 2 package into a folder, without overwriting changed files."""

import ast
import os
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from cbtui.eject.ament_package import AmentPackage, LessonProgram, imported_modules
from lessons.lesson import Lesson
from sim.files.atomic import write_atomically
from sim.packages import Package, PackageError

_NUMBERED = re.compile(r"(?P<number>\d[\w.]*)\s+(?P<title>.*)", re.DOTALL)


class EjectError(Exception):
    """The packages cannot be written; the text is a sentence."""


@dataclass(frozen=True)
class CourseUnit:
    """A unit of the course and its lessons in order; ``number`` may be empty."""

    number: str
    title: str
    package: str
    """The name of its package, valid by REP 144."""
    lessons: tuple[Lesson, ...]


def units_of(lessons: Iterable[Lesson]) -> list[CourseUnit]:
    """Return the units of some lessons in the lessons' order."""
    units: dict[str, CourseUnit] = {}
    for lesson in lessons:
        number, title = _number_and_title(lesson.unit)
        package = _package_name(f"unit{number}" if number else title)
        before = units.get(package, CourseUnit(number, title, package, ()))
        units[package] = CourseUnit(before.number, before.title, package, (*before.lessons, lesson))
    return list(units.values())


def chosen(units: Sequence[CourseUnit], names: Sequence[str]) -> list[CourseUnit]:
    """Return the units of these numbers or package names; all of them where none is named.

    Raises:
        EjectError: there is no such unit.
    """
    for name in names:
        if not any(name in (unit.number, unit.package) for unit in units):
            known = ", ".join(unit.number or unit.package for unit in units)
            raise EjectError(f"there is no unit {name}; there are: {known}")
    return [unit for unit in units if not names or {unit.number, unit.package} & {*names}]


def package_of(unit: CourseUnit) -> AmentPackage:
    """Return the unit as a package.

    If a package of that name lies beside the lessons, its executable names and launch files are included.

    Raises:
        EjectError: a node cannot be read, or cannot be part of a package as it is.
    """
    programs = tuple(program for lesson in unit.lessons for program in _programs(lesson))
    also: dict[str, LessonProgram] = {}
    launch_files: dict[str, bytes] = {}
    for package in _packages_beside(unit):
        try:
            also |= _further_names(package, programs)
            launch_files |= {name: package.launch_file(name).read_bytes() for name in package.launch_files}
        except PackageError as error:
            raise EjectError(str(error)) from None
    return AmentPackage(
        name=unit.package,
        title=" ".join(unit.title.split()),
        programs=programs,
        also=also,
        launch_files=launch_files,
    )


def changed_files(files: Mapping[Path, bytes]) -> list[Path]:
    """Return the files that exist with different content. Raises OSError."""
    return [path for path, content in files.items() if os.path.lexists(path) and not _holds(path, content)]


def write_files(files: Mapping[Path, bytes]) -> int:
    """Write the files that are missing or different; returns their number.

    Each write is atomic; a link is replaced, not followed. Raises OSError.
    """
    missing = {path: content for path, content in files.items() if not _holds(path, content)}
    for path, content in missing.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        write_atomically(path, content, follow=False)
    return len(missing)


def _holds(path: Path, content: bytes) -> bool:
    return path.is_file() and path.read_bytes() == content


def _number_and_title(unit: str) -> tuple[str, str]:
    parts = _NUMBERED.fullmatch(unit.strip())
    return ("", unit) if parts is None else (parts["number"], parts["title"])


def _package_name(text: str) -> str:
    """A name as REP 144 wants it: lower case, letters first, single underscores."""
    words = re.findall(r"[a-z0-9]+", text.lower())
    name = "_".join((*words, "pkg"))
    return name if name[0].isalpha() else f"unit_{name}"


def _packages_beside(unit: CourseUnit) -> list[Package]:
    folders = {lesson.folder.parent / unit.package: None for lesson in unit.lessons}
    return [Package(unit.package, folder) for folder in folders if (folder / "package.xml").is_file()]


def _further_names(package: Package, programs: Sequence[LessonProgram]) -> dict[str, LessonProgram]:
    """The lesson's program for each executable of a package, matched by its source.

    A package has links to the nodes, or, once installed, copies of them.
    """
    found: dict[str, LessonProgram] = {}
    for name in package.executables:
        path = package.executable(name).path
        source = path.read_bytes()
        same = next((program for program in programs if program.source == source), None)
        if same is None:
            raise EjectError(f"{path} is the node of no lesson, so that the executable {name} would be lost")
        found[name] = same
    taken = {program.name for program in programs}
    return {name: program for name, program in found.items() if name not in taken}


def _programs(lesson: Lesson) -> Iterator[LessonProgram]:
    """The lesson's node, and the solution of its exercise if it has one."""
    name = lesson.id.replace("-", "_")
    yield _program(lesson, lesson.node_path, name, lesson.title, lesson.teaches)
    if lesson.exercise is not None and lesson.solution_path is not None:
        title = f"{lesson.title}: its exercise, solved"
        yield _program(lesson, lesson.solution_path, f"{name}_solution", title, lesson.exercise.asks)


def _program(lesson: Lesson, path: Path, name: str, title: str, teaches: str) -> LessonProgram:
    try:
        source = path.read_bytes()
        modules = imported_modules(source)
    except OSError as error:
        raise EjectError(f"{path} cannot be read: {error.strerror}") from None
    except (SyntaxError, ValueError) as error:
        raise EjectError(f"{path} is not Python: {error}") from None
    if not _has_main(source):
        raise EjectError(f"{path} has no function main(), which an executable of a package starts with")
    for module in sorted(modules):
        if (path.parent / f"{module}.py").is_file() or (path.parent / module).is_dir():
            raise EjectError(f"{path} imports {module} from its own folder, which a package has no place for")
    offered = lesson.service.name.lstrip("/").encode() in source
    return LessonProgram(
        name=name,
        title=title,
        teaches=teaches,
        source=source,
        arguments=tuple(lesson.arguments_with(None)),
        service=(lesson.service.name, lesson.service.type) if offered else None,
    )


def _has_main(source: bytes) -> bool:
    return any(isinstance(node, ast.FunctionDef) and node.name == "main" for node in ast.parse(source).body)
