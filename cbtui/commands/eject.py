"""``cbtui eject``: writes the lessons' nodes as packages that ``colcon build`` takes."""

import argparse
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from stat import S_ISDIR
from typing import TYPE_CHECKING

from cbtui.text.output import CannotSayError, complain, say
from sim.files.untrusted import mode_of
from sim.quantities.plural import counted

if TYPE_CHECKING:
    from cbtui.eject.ament_package import AmentPackage


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument(
        "folder", metavar="DIR", type=Path, help="where the packages go, such as the src of a workspace"
    )
    parser.add_argument(
        "--unit",
        dest="units",
        metavar="N",
        action="append",
        default=[],
        help="only this unit; may be given again",
    )
    parser.add_argument(
        "--force", action="store_true", help="replace files that were changed; without it they stay"
    )


def eject(options: argparse.Namespace) -> int:
    """Write the packages; returns the exit code: 0 on success, 2 for wrong arguments or a file in the way."""
    from cbtui.eject.eject import EjectError
    from lessons.lesson import BadLesson

    folder: Path = options.folder
    try:
        packages = _packages(folder, options.units)
        files = {package.name: _files(folder, package) for package in packages}
        if not options.force:
            _refuse_changed(files.values())
        for package in packages:
            _write(package, folder, files[package.name])
    except (EjectError, BadLesson) as error:
        complain(str(error))
        return 2
    except (BrokenPipeError, CannotSayError):
        raise  # warns about standard output, not about a file
    except OSError as error:
        place = error.filename2 or error.filename or folder
        complain(f"cannot write {place}: {error.strerror}")
        return 2
    selected = " ".join(package.name for package in packages)
    say(f"In the workspace, on a ROS 2 machine: colcon build --packages-select {selected}\n")
    return 0


def _packages(folder: Path, names: Sequence[str]) -> "list[AmentPackage]":
    """Return the packages of the named units, or of all units if none is named."""
    from cbtui.eject.eject import EjectError, chosen, package_of, units_of
    from lessons.catalogue import lessons

    if (mode := mode_of(folder)) and not S_ISDIR(mode):
        raise EjectError(f"{folder} is a file; name a folder for the packages")
    return [package_of(unit) for unit in chosen(units_of(lessons()), names)]


def _files(folder: Path, package: "AmentPackage") -> dict[Path, bytes]:
    return {folder / package.name / place: content for place, content in package.files().items()}


def _refuse_changed(packages: Iterable[Mapping[Path, bytes]]) -> None:
    from cbtui.eject.eject import EjectError, changed_files

    changed = [path for files in packages for path in changed_files(files)]
    match changed:
        case []:
            return
        case [only]:
            raise EjectError(f"{only} is there with other content; --force replaces it")
        case [first, _]:
            raise EjectError(f"{first} and 1 other file are there with other content; --force replaces them")
        case [first, *others]:
            raise EjectError(
                f"{first} and {len(others)} other files are there with other content; --force replaces them"
            )


def _write(package: "AmentPackage", folder: Path, files: Mapping[Path, bytes]) -> None:
    """Write a package, and print what was written."""
    from cbtui.eject.eject import write_files

    written = write_files(files)
    kept = f", {len(files) - written} were there" if written < len(files) else ""
    lessons = counted(len(package.programs), "lesson")
    say(f"{folder / package.name}: {lessons}, {counted(written, 'file')} written{kept}\n")
