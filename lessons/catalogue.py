"""All lessons in teaching order, and the search for one by its id.

The package's own lessons are followed by others: from folders that an environment variable names, and from
packages that are registered under the entry-point group ``cbtui.lessons``.
"""

import os
import sys
from collections.abc import Iterable, Iterator
from functools import cache
from itertools import zip_longest
from pathlib import Path
from typing import NamedTuple

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

    They are read once for each value of the environment variable. Lessons at fault are left out.

    Raises:
        BadLesson: a place for lessons has none.
    """
    return _catalogue(os.environ.get(VARIABLE, "")).lessons


def faults() -> tuple[BadLesson, ...]:
    """Return what is wrong with the lessons that were left out. Raises BadLesson as ``lessons``."""
    return tuple(_catalogue(os.environ.get(VARIABLE, "")).faults.values())


def find(lesson_id: str) -> Lesson:
    """Return the lesson with this id or number.

    Raises:
        BadLesson: it is at fault.
        UnknownLesson: there is none; the text names one that is near.
    """
    for lesson in lessons():
        if lesson_id in (lesson.id, str(lesson.number)):
            return lesson
    for folder, fault in _catalogue(os.environ.get(VARIABLE, "")).faults.items():
        if folder.name == lesson_id:
            raise fault
    if lesson_id.isdecimal():
        raise UnknownLesson(f"there are {len(lessons())} lessons, and none is number {lesson_id}")
    raise UnknownLesson(f"no lesson is called {lesson_id!r}; {_nearest(lesson_id)}cbtui list shows all")


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
    return _sorted(read_lesson(place) for place in _places_in(folder))


class _Catalogue(NamedTuple):
    lessons: tuple[Lesson, ...]
    faults: dict[Path, BadLesson]
    """What is wrong with the others, by their folders."""


@cache
def _catalogue(folders: str) -> _Catalogue:
    faults: dict[Path, BadLesson] = {}
    places = [place for unit in ROOT.glob("unit*") for place in _places_in(unit)]
    every = _sorted(_readable(places, faults))
    for folder, source in {folder: source for source, folder in _elsewhere(folders)}.items():
        added = _places_in(folder)
        if not added:
            raise BadLesson(f"{source}: there is no lesson in {folder}")
        every += _sorted(_readable(added, faults))
    known: dict[str, Lesson] = {}
    for lesson in every:
        other = known.setdefault(lesson.id, lesson)
        if other is not lesson:
            faults[lesson.folder] = BadLesson(
                f"{lesson.folder / DESCRIPTION_FILE}: the field 'id' is wrong: "
                f"the lesson in {other.folder} is called {lesson.id!r} too"
            )
    every = tuple(known.values())
    numbered = enumerate(zip_longest(every, every[1:]), start=1)
    return _Catalogue(
        tuple(
            structs.replace(lesson, number=place, following=_announcement(following))
            for place, (lesson, following) in numbered
        ),
        faults,
    )


def _places_in(folder: Path) -> list[Path]:
    places = ("", "*/", "*/*/")
    return sorted(path.parent for place in places for path in folder.glob(f"{place}{DESCRIPTION_FILE}"))


def _readable(places: list[Path], faults: dict[Path, BadLesson]) -> Iterator[Lesson]:
    for place in places:
        try:
            yield read_lesson(place)
        except BadLesson as fault:
            faults[place] = fault


def _sorted(found: Iterable[Lesson]) -> tuple[Lesson, ...]:
    return tuple(sorted(found, key=lambda lesson: lesson.number))


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


def _nearest(lesson_id: str) -> str:
    from difflib import get_close_matches  # only needed for a wrong id

    near = get_close_matches(lesson_id.lower(), [lesson.id for lesson in lessons()], n=1)
    return f"the nearest is {near[0]!r}, and " if near else ""
