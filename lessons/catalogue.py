"""All lessons in teaching order, and the search for one by its id.

The package's own lessons are followed by others: from folders that an environment variable names, and from
packages that are registered under the entry-point group ``cbtui.lessons``.
"""

import os
import sys
from collections.abc import Iterator
from functools import cache
from itertools import zip_longest
from pathlib import Path

from msgspec import structs

from lessons.lesson import DESCRIPTION_FILE, BadLesson, Lesson, read_lesson

ROOT = Path(__file__).parent
VARIABLE = "CBTUI_LESSONS"
"""The environment variable that names folders with more lessons, as ``PATH`` does."""
ENTRY_POINTS = "cbtui.lessons"
"""The entry-point group whose values are packages in whose folders lessons lie."""


class UnknownLesson(LookupError):  # noqa: N818 - the sentence it carries is what a reader sees
    """No lesson has the id that was asked for; the text is one sentence, naming one that is near."""


def lessons() -> tuple[Lesson, ...]:
    """Return every lesson in teaching order, numbered from 1; those from elsewhere follow the package's own.

    They are read once for each value of the environment variable.

    Raises:
        BadLesson: a lesson's folder is at fault, two lessons have one id, or a place for lessons has none.
    """
    return _lessons(os.environ.get(VARIABLE, ""))


def find(lesson_id: str) -> Lesson:
    """Return the lesson with this id or number. Raises UnknownLesson, which names one that is near."""
    for lesson in lessons():
        if lesson_id in (lesson.id, str(lesson.number)):
            return lesson
    if lesson_id.isdecimal():
        raise UnknownLesson(f"There are {len(lessons())} lessons, and none is number {lesson_id}.")
    raise UnknownLesson(f"No lesson is called {lesson_id!r}; {_nearest(lesson_id)}'cbtui list' shows all.")


def lesson_on(problem: str) -> Lesson | None:
    """Return the lesson whose node shows a kind of problem and the fewest others; None if there is none."""
    shown = [each for each in lessons() if problem in (*each.diagnoses.node, *each.diagnoses.shows)]
    return min(shown, key=lambda lesson: len(lesson.diagnoses.node), default=None)


def is_built_in(lesson: Lesson) -> bool:
    """Tell whether a lesson is one of the package's own; code of others only runs when a user opens them."""
    return lesson.folder.is_relative_to(ROOT)


def lessons_in(folder: Path) -> tuple[Lesson, ...]:
    """Return the lessons of a folder and of folders in it, by their numbers; it may be a lesson itself.

    Raises:
        BadLesson: one of them is invalid.
    """
    places = ("", "*/", "*/*/")
    paths = [path for place in places for path in folder.glob(f"{place}{DESCRIPTION_FILE}")]
    found = [read_lesson(path.parent) for path in sorted(paths)]
    return tuple(sorted(found, key=lambda lesson: lesson.number))


@cache
def _lessons(folders: str) -> tuple[Lesson, ...]:
    own = [lesson for unit in ROOT.glob("unit*") for lesson in lessons_in(unit)]
    every = sorted(own, key=lambda lesson: lesson.number)
    for folder, source in {folder: source for source, folder in _elsewhere(folders)}.items():
        added = lessons_in(folder)
        if not added:
            raise BadLesson(f"{source}: there is no lesson in {folder}")
        every += added
    _check_ids(every)
    return tuple(
        structs.replace(lesson, number=place, following=_announcement(following))
        for place, (lesson, following) in enumerate(zip_longest(every, every[1:]), start=1)
    )


def _announcement(following: Lesson | None) -> str:
    if following is None:
        return ""
    return (
        f"*{following.title}*"
        if following.teaser is None
        else f"*{following.title}*, which {following.teaser}"
    )


def _elsewhere(folders: str) -> Iterator[tuple[str, Path]]:
    """Yield the places of further lessons, each with the variable or package that names it."""
    for name in filter(None, folders.split(os.pathsep)):
        folder = Path(name).resolve()
        if not folder.is_dir():
            raise BadLesson(f"{VARIABLE}: there is no folder {name}")
        yield VARIABLE, folder
    yield from _announced()


def _announced() -> Iterator[tuple[str, Path]]:
    if not _names_the_group():
        return
    from importlib.metadata import entry_points

    for point in entry_points(group=ENTRY_POINTS):
        source = f"the entry point {point.name!r} of {ENTRY_POINTS}"
        locations = _locations(point.value)
        if not locations:
            raise BadLesson(f"{source}: there is no package {point.value!r}")
        for location in locations:
            yield source, Path(location)


def _names_the_group() -> bool:
    """Whether an installed package names the entry-point group.

    To import ``importlib.metadata``, and have it read all that is installed, takes ten times as long.
    """
    return any(
        ENTRY_POINTS.encode() in file.read_bytes()
        for folder in dict.fromkeys(sys.path)
        for file in Path(folder).glob("*-info/entry_points.txt")
    )


def _locations(package: str) -> list[str]:
    """Return the folders of a package, none if it does not exist; neither it nor its parents are imported."""
    from importlib.machinery import PathFinder
    from importlib.util import find_spec

    first, *others = package.split(".")
    try:
        spec = find_spec(first) if first else None
        for depth in range(len(others)):
            above = spec and spec.submodule_search_locations
            # importlib.util.find_spec imports the parents of a package.
            spec = PathFinder.find_spec(".".join([first, *others[: depth + 1]]), above) if above else None
    except (ImportError, ValueError):  # not a name, or the name of a module without a spec
        return []
    return list((spec and spec.submodule_search_locations) or ())


def _check_ids(every: list[Lesson]) -> None:
    known: dict[str, Lesson] = {}
    for lesson in every:
        other = known.setdefault(lesson.id, lesson)
        if other is not lesson:
            path = lesson.folder / DESCRIPTION_FILE
            raise BadLesson(
                f"{path}: the field 'id' is wrong: the lesson in {other.folder} is called {lesson.id!r} too"
            )


def _nearest(lesson_id: str) -> str:
    from difflib import get_close_matches  # only needed for a wrong id

    near = get_close_matches(lesson_id.lower(), [lesson.id for lesson in lessons()], n=1)
    return f"the nearest is {near[0]!r}, and " if near else ""
