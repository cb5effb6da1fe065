"""``cbtui run``: runs a lesson, or files, without the console."""

import argparse
import math
from pathlib import Path
from typing import TYPE_CHECKING

from cbtui.commands.options import changes, inputs, more_lessons, outputs, values
from cbtui.commands.options.seeds import add_seed, check_seed
from cbtui.commands.options.targets import RunTargets, is_file_name, refuse, targets_of
from cbtui.text.output import complain

if TYPE_CHECKING:
    from cbtui.runs.setup.lesson_setup import RunRequest
    from sim.engine.setup import RunSetup

DEFAULT_SECONDS = 60.0


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument(
        "targets",
        metavar="LESSON|FILE.py",
        nargs="*",
        help="a lesson's id, see cbtui list, or node files or a launch file",
    )
    inputs.add_length(parser, f"how long the run lasts in its own time ({DEFAULT_SECONDS:g})")
    changes.add_options(parser)
    add_seed(parser)
    changes.add_on(parser)
    changes.add_traceback(parser)
    inputs.add_options(parser)
    inputs.add_typing(parser)
    parser.add_argument(
        "--call-data", choices=("true", "false"), default="true", help="what the calls send (%(default)s)"
    )
    parser.add_argument(
        "--inputs",
        metavar="FILE.mcap",
        help="give the run what a recorded one was given, at the same moments; without LESSON: repeat it",
    )
    parser.add_argument("--no-robot", dest="robot", action="store_false", help="leave out the lessons' robot")
    parser.add_argument(
        "--clock",
        choices=("virtual", "real"),
        help="which time it runs on (a lesson's own, mostly virtual; a file: real)",
    )
    parser.add_argument(
        "--speed",
        metavar="X",
        type=values.speed,
        default=math.inf,
        help="seconds of the run per real second, or max (max; on the real clock 1)",
    )
    add_chain(parser)
    parser.add_argument(
        "--events",
        metavar="FILE.jsonl",
        type=outputs.file_or_stream,
        help="write each event as a line of JSON to this file; - is standard output",
    )
    parser.add_argument(
        "--json",
        metavar="FILE.json",
        type=outputs.file_or_stream,
        help="write the summary and the diagnosis as JSON, too; - is standard output",
    )
    parser.add_argument(
        "--record",
        metavar="FILE.mcap",
        type=outputs.file_or_stream,
        help="record the run, with its topics as rosbag2 and Foxglove read them",
    )
    outputs.add_force(parser)
    parser.add_argument(
        "--fail-on", choices=("problem",), help="end with 1 if the diagnosis has a problem (!), too"
    )
    more_lessons.add_option(parser)


def add_chain(parser: argparse.ArgumentParser) -> None:
    """Add ``--chain``, which may be repeated."""
    parser.add_argument(
        "--chain",
        dest="chains",
        metavar="FIRST:LAST",
        type=values.chain,
        action="append",
        default=[],
        help="report how long messages took from one topic to another, and where: /scan:/cmd_vel; "
        "what lies between may be named as well; may be given again",
    )


def run(options: argparse.Namespace) -> int:
    """Run lessons or files headless; returns the exit code."""
    if options.inputs is not None:
        return _repeat(options)
    if not options.targets:
        refuse("run needs a LESSON or a FILE.py; cbtui list lists the lessons")
    options.seconds = options.seconds or DEFAULT_SECONDS
    _check_run(options, is_file=is_file_name(options.targets[0]))
    program = targets_of(options.targets)
    _check_outputs(options, program.files)
    lesson = program.lesson
    check_seed(options.seed, options.clock or (None if lesson is None else lesson.setup.clock))
    return _run(_request(options, program).setup(), options)


def _repeat(options: argparse.Namespace) -> int:
    if options.clock == "real":
        refuse("only runs on the virtual clock can be repeated exactly; leave out --clock real")
    if options.calls or options.lines or options.typed:
        refuse("--inputs gives the run all its inputs; leave out --call, --at and --type")
    _check_outputs(options, [Path(name) for name in (options.inputs, *options.targets)])
    from cbtui.runs.recorded.repeat import CannotRepeatError, repeated_setup

    request = _request(options, targets_of(options.targets))
    try:
        setup = repeated_setup(Path(options.inputs), request, tell=complain)
    except CannotRepeatError as error:
        refuse(str(error))
    return _run(setup, options)


def _run(setup: "RunSetup", options: argparse.Namespace) -> int:
    from cbtui.runs.headless.headless import run_headless

    return run_headless(
        setup,
        events_path=options.events,
        summary_path=options.json,
        recording_path=options.record,
        replace_recording=options.force or options.record == outputs.STANDARD_OUTPUT,
        chains=options.chains,
        fail_on_problem=options.fail_on == "problem",
    )


def _request(options: argparse.Namespace, program: RunTargets) -> "RunRequest":
    from cbtui.runs.setup.lesson_setup import RunRequest
    from sim.engine.setup import Keyboard

    return RunRequest(
        lesson=program.lesson,
        files=program.files,
        arguments=options.arguments,
        changes=changes.seeded_changes_of(options),
        clock=options.clock or (None if options.seed is None else "virtual"),
        speed=None if options.speed == math.inf else options.speed,
        robot=options.robot,
        seconds=options.seconds,
        calls=options.calls,
        call_data=options.call_data == "true",
        lines=options.lines,
        typed=options.typed,
        keyboard=Keyboard.NOBODY if options.typed else Keyboard.LIVE,
        contents=options.record is not None,
    )


def _check_outputs(options: argparse.Namespace, taken: list[Path]) -> None:
    outputs.check_outputs(
        {"--events": options.events, "--json": options.json, "--record": options.record},
        taken,
        force=options.force,
    )


def _check_run(options: argparse.Namespace, *, is_file: bool) -> None:
    inputs.check(options, options.seconds)
    if options.arguments and not is_file:
        refuse("a lesson has its own arguments; leave out what follows --")
