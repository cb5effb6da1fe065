"""``cbtui compare``: two runs side by side; each is a recording, a lesson or a file."""

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from cbtui.commands.console import run_console
from cbtui.commands.options import appearance, changes, inputs, values
from cbtui.commands.options.targets import RECORDING, file_of, is_file_name, is_recording, lesson_of, refuse
from cbtui.commands.run import DEFAULT_SECONDS

if TYPE_CHECKING:
    from cbtui.runs.compared_runs import ComparedRun, ComparisonTerms
    from cbtui.runs.setup.changes import Changes


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    for name in ("A", "B"):
        parser.add_argument(name, help=f"a recording ({RECORDING}), a lesson's id, or a node or launch file")
    appearance.add_options(parser)
    parser.add_argument("--text", action="store_true", help="print the table, as without a terminal")
    parser.add_argument(
        "--from",
        dest="start",
        metavar="SECONDS",
        type=values.moment,
        default=0.0,
        help="where to begin (%(default)g)",
    )
    parser.add_argument(
        "--to",
        "--for",
        dest="end",
        metavar="SECONDS",
        type=values.duration,
        help=f"where to end (where the shorter recording does; {DEFAULT_SECONDS:g} where there is none)",
    )
    for letter in "ab":
        parser.add_argument(
            f"--threads-{letter}",
            metavar="N",
            type=values.threads,
            help=f"number of threads of {letter.upper()}'s executor, instead of its own",
        )
        changes.add_groups_and_periods(parser, f"-{letter}")
        changes.add_distro(parser, f"-{letter}")
        changes.add_on(parser, f"-{letter}")
    inputs.add_options(parser)
    parser.add_argument(
        "--inputs",
        metavar=f"FILE{RECORDING}",
        help="give what is run what a recorded run was given, at the same moments",
    )


def compare(options: argparse.Namespace) -> int:
    """Compare two runs in the console or as text; returns the exit code."""
    _check(options)
    first, second = (
        _compared_run(name, changed, options.arguments)
        for name, changed in ((options.A, _changes(options, "a")), (options.B, _changes(options, "b")))
    )
    terms = _terms(options)
    look = appearance.appearance(options)
    if options.text or look.screen_reader or not (sys.stdin.isatty() and sys.stdout.isatty()):
        from cbtui.runs.compared_runs import compare_runs

        return compare_runs(first, second, terms, in_lines=look.screen_reader and not options.text)
    return run_console(look, start_comparison=(first, second, terms))


def _check(options: argparse.Namespace) -> None:
    names = [options.A, options.B]
    for letter, name in zip("ab", names, strict=True):
        is_real = getattr(options, f"on_{letter}") != "model"
        if is_real and options.inputs is not None:
            refuse(f"a run on real ROS 2 cannot be repeated; leave out --inputs, or --on-{letter}")
        given_options = {
            "threads": getattr(options, f"threads_{letter}"),
            "group": getattr(options, f"groups_{letter}"),
            "period": getattr(options, f"periods_{letter}"),
            "distro": getattr(options, f"distro_{letter}"),
            "on": is_real,
        }
        for option, given in given_options.items():
            if given and is_recording(name):
                refuse(f"{name} is a recording and stays as it is; leave out --{option}-{letter}")
    if all(map(is_recording, names)):
        for option, given in (
            ("--call", options.calls),
            ("--at", options.lines),
            ("--inputs", options.inputs),
        ):
            if given:
                refuse(f"two recordings are compared and nothing is run; leave out {option}")
    if options.inputs is not None and (options.calls or options.lines):
        refuse("--inputs gives what is run all its inputs; leave out --call and --at")
    if options.arguments and not any(is_file_name(name) for name in names if not is_recording(name)):
        refuse("only a file takes arguments; leave out what follows --")


def _changes(options: argparse.Namespace, letter: str) -> "Changes":
    from cbtui.runs.setup.changes import Changes

    real = changes.real_ros_of(options, f"-{letter}")
    threads, groups, periods, distro = (
        getattr(options, f"{name}_{letter}") for name in ("threads", "groups", "periods", "distro")
    )
    return Changes(threads, dict(groups), dict(periods), distro=distro, real=real)


def _compared_run(name: str, changed: "Changes", arguments: list[str]) -> "ComparedRun":
    from cbtui.runs.compared_runs import ComparedRun
    from cbtui.runs.setup.lesson_setup import RunRequest

    if is_recording(name):
        return ComparedRun(name, _readable(Path(name)))
    called = ", ".join(filter(None, (name, changed.words)))
    if is_file_name(name):
        file = file_of(name)
        request = RunRequest(files=[file], arguments=arguments, changes=changed, clock="virtual")
        return ComparedRun(called, request)
    return ComparedRun(called, RunRequest(lesson=lesson_of(name, or_file=True), changes=changed))


def _readable(path: Path) -> Path:
    """Return a recording's path; exits with code 2 and one line if it cannot be opened."""
    from sim.recording import RecordingError, read

    try:
        read(path)
    except (RecordingError, ValueError) as error:
        refuse(str(error))
    return path


def _terms(options: argparse.Namespace) -> "ComparisonTerms":
    from cbtui.runs.compared_runs import ComparisonTerms

    if options.end is not None and options.end <= options.start:
        refuse(f"nothing is left to compare from {options.start:g} s to {options.end:g} s")
    return ComparisonTerms(
        start=options.start,
        end=options.end,
        calls=options.calls,
        lines=options.lines,
        inputs=None if options.inputs is None else _readable(Path(options.inputs)),
    )
