"""Examines folders that are written to, and files: configuration, progress and lessons."""

import os
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

from cbtui.doctor.examination import Examination, fault, note, well
from cbtui.keys.config import read_file, standard_path
from lessons.catalogue import ROOT, VARIABLE, faults, lessons
from lessons.lesson import BadLesson
from lessons.progress import faulty_line, usual_path
from sim.files.untrusted import mode_of


def folders(current: Callable[[], Path]) -> Iterator[Examination]:
    """Examine whether the folders of cbtui's files can be written to; nothing is written."""
    yield _folder(
        "state folder",
        usual_path().parent,
        "set HOME or XDG_STATE_HOME to a folder of yours, and progress is kept",
    )
    yield _temporary()
    try:
        here = current()
    except OSError:
        yield note("this folder", "is not there any more", "go to another; exercises are written here")
        return
    yield _folder(
        "this folder", here, "go to a folder of yours before cbtui start and recordings, which write there"
    )


def _temporary() -> Examination:
    try:
        return well("temp folder", tempfile.gettempdir())
    except OSError:
        return fault(
            "temp folder", "there is none to write to", "set TMPDIR to a folder of yours; a run needs one"
        )


def _folder(subject: str, folder: Path, remedy: str) -> Examination:
    if not folder.is_absolute():
        return note(subject, "there is no home folder", remedy)
    if not is_writable(folder):
        return note(subject, f"{folder} cannot be written to", remedy)
    return well(subject, str(folder))


def is_writable(folder: Path) -> bool:
    """Tell whether files can be created in a folder, which need not exist yet."""
    try:
        nearest = next(each for each in (folder, *folder.parents) if mode_of(each))
    except (OSError, StopIteration):
        return False
    return nearest.is_dir() and os.access(nearest, os.W_OK | os.X_OK)


def configuration(named: Path | None) -> Iterator[Examination]:
    """Examine the named configuration, else the user's own."""
    path = named or standard_path()
    try:
        there = bool(mode_of(path))
    except OSError:
        there = True  # reading it reports why
    if named is None and not path.is_absolute():
        remedy = "set HOME or XDG_CONFIG_HOME, or name a file with --config, for keys and colours of your own"
        yield note("config", "there is no home folder", remedy)
        return
    if named is None and not there:
        yield well("config", f"none ({path} would be it; cbtui keys writes one to begin with)")
        return
    complaints = read_file(path).complaints
    for complaint in complaints:
        yield note("config", complaint, f"fix {path}; until then this entry is left out")
    if not complaints:
        yield well("config", str(path))


def progress() -> Examination:
    """Examine the progress file."""
    path = usual_path()
    remedy = f"the next console keeps it under another name and goes on; fix or delete {path}"
    try:
        if not path.is_absolute() or not mode_of(path):
            return well("progress", "none yet")
        line = faulty_line(path)
    except OSError as error:
        return note(
            "progress", f"{path} cannot be read ({error.strerror})", "give yourself the right to read it"
        )
    if line is not None:
        return note("progress", f"{path.name}:{line} is no progress", remedy)
    return well("progress", str(path))


def lessons_found() -> Iterator[Examination]:
    """Examine all lessons, those from other folders included."""
    try:
        every, troubles = lessons(), faults()
    except BadLesson as error:
        every, troubles = (), (error,)
    for trouble in troubles:
        yield fault("lessons", str(trouble), f"fix it, or take its folder out of {VARIABLE}")
    if not every:
        return
    elsewhere = [lesson for lesson in every if not lesson.folder.is_relative_to(ROOT)]
    more = f", {len(elsewhere)} of them from elsewhere" if elsewhere else ""
    yield well("lessons", f"{len(every)}{more}")
