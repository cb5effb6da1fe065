"""``cbtui grade``: the files of a folder of learners, run and checked one after another."""

import argparse
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from cbtui.commands.check import add_limit, exercise_of
from cbtui.commands.options import changes, more_lessons, outputs
from cbtui.commands.options.targets import folder_of, refuse
from cbtui.text.output import complain, say, say_data
from sim.files.untrusted import mode_of

if TYPE_CHECKING:
    from cbtui.grading.grading import Grader, HandIn
    from cbtui.grading.mark_sheet import MarkSheet, SheetRow

_STANDARD_OUTPUT = "-"
SUSPICIOUS = 3
"""Exit code when a trace shows signs of a forgery."""
CHANGED = 4
"""Exit code when a submission changed cbtui or a lesson, which ends the grading."""

DESCRIPTION = """Run and check what lies in DIR: a folder for each learner with files such as split_groups.py,
or a file for each. The files are programs, and are run: each on a copy, and with bwrap (of the package
bubblewrap) in namespaces of its own, without a network, other processes, other submissions, checks
and solutions. Without bwrap it can read and write whatever you can. Either way it shares the
process that traces it: one that knows how can write a trace of its own. What gives that away (a
broken seal, functions of the engine that were replaced, callbacks that were not handed in, events
that cannot follow one another) is reported as suspicious and earns no marks; read such files
yourself. With --on ros2 each runs on real rclpy, at its pace; there it tells itself what its own
callbacks did, but cannot lie of the robot and of calls from outside. Ends with 0 if all pass, 1 if
some do not, 3 if something is suspicious, 4 if a submission changed cbtui or a lesson, which ends the
grading."""


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("folder", metavar="DIR", help="a folder with a folder or a file for each learner")
    parser.add_argument("--lesson", metavar="LESSON", help="the exercise that all files are for")
    parser.add_argument(
        "--csv",
        metavar="OUT.csv",
        nargs="?",
        const=_STANDARD_OUTPUT,
        help="write the table as CSV, row by row, to a file or to standard output",
    )
    parser.add_argument(
        "--junit",
        metavar="OUT.xml",
        type=outputs.file_or_stream,
        help="write the results as JUnit XML, for a CI server; - is standard output",
    )
    parser.add_argument(
        "--resume",
        action="store_true",
        help="keep the rows that are in OUT.csv already, and grade what is missing there or was changed",
    )
    outputs.add_force(parser)
    add_limit(parser, 30)
    changes.add_on(parser)
    more_lessons.add_option(parser)


def grade(options: argparse.Namespace) -> int:
    """Check every learner's files; returns the exit code."""
    real = changes.real_ros_of(options)
    papers = _papers(options)
    path = None if options.csv in {None, _STANDARD_OUTPUT} else Path(options.csv)
    junit = None if options.junit is None else Path(options.junit)
    if (options.csv, options.junit) == (_STANDARD_OUTPUT, outputs.STANDARD_OUTPUT):
        refuse("--csv and --junit cannot both go to standard output; give one of them a file")
    if options.resume and path is None:
        refuse("--resume goes on with a table; name it with --csv OUT.csv")
    files = [paper.file for paper in papers if paper.file is not None]
    force = options.force or options.resume
    outputs.check_outputs({"--junit": junit, "--csv": path}, files, force=force)
    from cbtui.grading.confinement import Confinement
    from cbtui.grading.grading import Grader, PackagesChangedError, line
    from cbtui.grading.mark_sheet import MarkSheet, SheetFile, SheetStream, UnwritableSheetError
    from cbtui.grading.results import junit_xml, missed_text

    handed_in = Grader(papers, real)
    sheet = MarkSheet(handed_in.most_checks)
    if options.resume and path is not None:
        _take_earlier(sheet, path, handed_in)
    hidden = [Path(options.folder), *_hidden(papers), *filter(None, (path, junit))]
    confinement = Confinement.best(hidden, real)
    if confinement.missing:
        complain(
            f"{confinement.missing}: each submission runs on a copy, but can read and write what you can, "
            "end your processes and use the network; grade where it can do no harm"
        )
    missing = [entry for entry in handed_in.entries if not sheet.holds(entry.key)]
    missing.sort(key=sheet.is_unfinished)
    if missing and sheet.is_unfinished(missing[-1]):
        learner, lesson, _ = missing[-1].key
        complain(f"grading was cut short while {lesson} of {learner} ran, which now comes last")
    report = say_data if options.csv == _STANDARD_OUTPUT else _nothing
    out = SheetStream(sheet, report) if path is None else SheetFile(sheet, path)
    is_changed = False
    try:
        out.begin()
        for each in handed_in.grades(out.begun(missing), options.limit, confinement, out.restored):
            out.append(sheet.add(each))
            if options.csv != _STANDARD_OUTPUT:
                say(f"{line(each)}\n")
    except PackagesChangedError as error:
        complain(str(error))
        is_changed = True
    except UnwritableSheetError as error:
        complain(str(error))
        return 1
    finally:
        with suppress(UnwritableSheetError):
            out.end()
    if options.csv != _STANDARD_OUTPUT:
        say(missed_text(sheet.rows, handed_in.asked))
    is_written = junit is None or _write(junit, junit_xml(sheet.rows, handed_in.asked))
    return CHANGED if is_changed else _exit_code(sheet.rows, is_written=is_written)


def _exit_code(rows: "list[SheetRow]", *, is_written: bool) -> int:
    if any(row["suspicious"] for row in rows):
        return SUSPICIOUS
    return 0 if is_written and all(row["passed"] == row["total"] != "0" for row in rows) else 1


def _nothing(_text: str) -> None:
    """Write nothing, as no table was asked for."""


def _take_earlier(sheet: "MarkSheet", path: Path, handed_in: "Grader") -> None:
    from cbtui.grading.mark_sheet import BadSheetError

    try:
        text = path.read_text(encoding="utf-8", errors="replace") if mode_of(path) else ""
        sheet.read(text, [entry.key for entry in handed_in.entries])
    except OSError as error:
        refuse(f"{path} cannot be read: {error.strerror}")
    except BadSheetError as error:
        refuse(f"--resume cannot go on with {path}: {error}")


def _hidden(papers: "list[HandIn]") -> "list[Path]":
    """Return the files and folders that no submission may see."""
    from lessons.catalogue import ROOT
    from lessons.personal import config_folder, state_folder

    folders = {paper.lesson.folder for paper in papers if paper.lesson is not None}
    return [ROOT, *sorted(folders), state_folder(), config_folder()]


def _write(path: Path, text: str) -> bool:
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        complain(f"{path} cannot be written: {error.strerror}")
        return False
    return True


def _papers(options: argparse.Namespace) -> "list[HandIn]":
    from cbtui.grading.grading import hand_ins_in
    from lessons.catalogue import faults, lessons

    for fault in faults():
        complain(f"what is handed in for this lesson is not graded: {fault}")
    only = None if options.lesson is None else exercise_of(options.lesson)
    folder = folder_of(options.folder)
    exercises = [lesson for lesson in lessons() if lesson.exercise is not None]
    try:
        papers = hand_ins_in(folder, exercises, only)
    except OSError as error:
        refuse(f"{folder} cannot be read: {error.strerror}")
    if not papers:
        refuse(f"{folder} has no learners' folders and no Python files in it")
    return papers
