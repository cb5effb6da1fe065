"""``cbtui grade``: the files of a folder of learners, checked one after another."""

import argparse
import os
from pathlib import Path
from typing import TYPE_CHECKING

from cbtui.commands import more_lessons
from cbtui.commands.check import add_limit, exercise_of
from cbtui.commands.output import complain, hand_over, say
from cbtui.commands.targets import folder_of, refuse, same_file

if TYPE_CHECKING:
    from cbtui.grading import Paper

_STANDARD_OUTPUT = "-"


def add_options(parser: argparse.ArgumentParser) -> None:
    """Give the command its arguments."""
    parser.add_argument("folder", metavar="DIR", help="a folder with a folder or a file for each learner")
    parser.add_argument("--lesson", metavar="LESSON", help="the exercise that all files are for")
    parser.add_argument(
        "--csv",
        metavar="OUT.csv",
        nargs="?",
        const=_STANDARD_OUTPUT,
        help="write the table as CSV, to a file or to standard output",
    )
    add_limit(parser, 30)
    more_lessons.add_option(parser)


def grade(options: argparse.Namespace) -> int:
    """Check every learner's files; returns the exit code: 0 all pass, 1 some do not."""
    papers = _papers(options)
    if options.csv not in {None, _STANDARD_OUTPUT}:
        _check_table(Path(options.csv), papers)
    from cbtui.grading import grades, line, table

    graded = []
    for each in grades(papers, options.limit):
        graded.append(each)
        if options.csv != _STANDARD_OUTPUT:
            say(f"{line(each)}\n")
    if options.csv == _STANDARD_OUTPUT:
        hand_over(table(graded))
    elif options.csv is not None:
        try:
            Path(options.csv).write_text(table(graded), encoding="utf-8", errors="backslashreplace")
        except OSError as error:
            complain(f"{options.csv} cannot be written: {error.strerror}")
            return 1
    return 0 if all(each.good for each in graded) else 1


def _check_table(path: Path, papers: "list[Paper]") -> None:
    """Refuse a table that can be written nowhere, before every file is run."""
    for paper in papers:
        if paper.file is not None and same_file(path, paper.file):
            refuse(f"--csv would overwrite {paper.file}; give it a file of its own")
    try:
        place = path if path.exists() else path.parent
        if path.is_dir():
            refuse(f"{path} cannot be written: it is a folder")
        if not place.exists():
            refuse(f"{path} cannot be written: there is no folder {place}")
    except OSError as error:
        refuse(f"{path} cannot be written: {error.strerror}")
    if not os.access(place, os.W_OK):
        refuse(f"{path} cannot be written: you may not write there")


def _papers(options: argparse.Namespace) -> "list[Paper]":
    from cbtui.grading import papers_in
    from lessons.catalogue import lessons

    only = None if options.lesson is None else exercise_of(options.lesson)
    folder = folder_of(options.folder)
    exercises = [lesson for lesson in lessons() if lesson.exercise is not None]
    try:
        papers = papers_in(folder, exercises, only)
    except OSError as error:
        refuse(f"{folder} cannot be read: {error.strerror}")
    if not papers:
        refuse(f"{folder} has no learners' folders and no Python files in it")
    return papers
