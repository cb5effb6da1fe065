"""``cbtui prove``: compares a program's runs on the model and on real ROS 2."""

import argparse
from textwrap import fill
from threading import Event
from typing import TYPE_CHECKING

from cbtui.commands.options import changes, inputs, more_lessons
from cbtui.commands.options.targets import RunTargets, refuse, targets_of
from cbtui.text.output import say
from sim.quantities.durations import timestamp
from sim.quantities.plural import counted

if TYPE_CHECKING:
    from cbtui.runs.compared_runs import RunPair
    from cbtui.runs.judged.proving import Difference
    from cbtui.runs.setup.lesson_setup import RunRequest

DEFAULT_SECONDS = 20.0
_MOST = 12
"""The most differences that are printed."""

DESCRIPTION = """Run a program on cbtui's model of rclpy and on real ROS 2, and tell whether it does the same:
how often and when each callback runs, what it waits for, how long it takes, what it logs, what the
diagnosis finds. Jitter of a machine is no difference, nor is the time that computing and finding each
other take there. Ends with 0 if both are the same, with 1 if they differ; cbtui compare shows both."""


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument(
        "targets", metavar="LESSON|FILE.py", nargs="+", help="a lesson's id, see cbtui list, or node files"
    )
    inputs.add_length(
        parser, f"how long each run lasts ({DEFAULT_SECONDS:g}; a lesson: as it says, with the calls it says)"
    )
    changes.add_options(parser)
    changes.add_python(parser, "the Python that has ROS 2")
    inputs.add_options(parser)
    parser.add_argument("--no-robot", dest="robot", action="store_false", help="leave out the lessons' robot")
    more_lessons.add_option(parser)


def prove(options: argparse.Namespace) -> int:
    """Compare a program's runs on both; returns the exit code: 0 if they are the same, 1 if they differ."""
    from dataclasses import replace

    from cbtui.runs.compared_runs import CannotCompareError, ComparedRun, ComparisonTerms, load_runs
    from cbtui.runs.judged.proving import RUN_NAMES, differences
    from cbtui.terminal.progress_line import ProgressLine

    program = targets_of(options.targets)
    request = _request(program, options)
    assert request.seconds is not None
    inputs.check(options, request.seconds)
    run = changes.chosen_ros(options.python)
    release = request.changes.distro or changes.release_of(run.python)
    request = replace(request, changes=replace(request.changes, distro=release))
    terms = ComparisonTerms(end=request.seconds, calls=tuple(request.calls), lines=tuple(request.lines))
    real = replace(request, changes=replace(request.changes, real=run, distro=None))
    model, rclpy = (ComparedRun(*each) for each in zip(RUN_NAMES, (request, real), strict=True))
    try:
        with ProgressLine() as line:
            pair = load_runs(model, rclpy, terms, lambda at: line.show(at.text), Event())
    except CannotCompareError as error:
        refuse(str(error))
    found = differences(pair.first.timeline, pair.second.timeline, pair.window)
    say(_told(pair, found))
    if found and program.lesson is not None and program.lesson.setup.not_on_ros2:
        say(f"  On real ROS 2 this lesson cannot be judged: {program.lesson.setup.not_on_ros2}.\n")
    return 1 if found else 0


def _request(program: RunTargets, options: argparse.Namespace) -> "RunRequest":
    """Return the request for the run on the model."""
    from dataclasses import replace

    from cbtui.runs.setup.lesson_setup import RunRequest, request_to_judge

    changed = changes.changes_of(options)
    if program.lesson is None:
        return RunRequest(
            files=program.files,
            arguments=options.arguments,
            changes=changed,
            clock="virtual",
            robot=options.robot,
            seconds=options.seconds or DEFAULT_SECONDS,
            calls=options.calls,
            lines=options.lines,
        )
    if options.arguments:
        refuse("a lesson has its own arguments; leave out what follows --")
    own = request_to_judge(program.lesson)
    is_as_it_says = options.seconds is None and not (options.calls or options.lines)
    return replace(
        own,
        changes=replace(changed, threads=changed.threads or own.changes.threads),
        robot=options.robot,
        seconds=options.seconds or own.seconds,
        calls=own.calls if is_as_it_says else options.calls,
        lines=own.lines if is_as_it_says else options.lines,
    )


def _told(pair: "RunPair", found: "list[Difference]") -> str:
    calls = [
        sum(side.timeline.calls_of(each, pair.window) for each in side.timeline.entities)
        for side in (pair.first, pair.second)
    ]
    counts = f"{counted(calls[0], 'call')} on {pair.first.name}, {calls[1]} on {pair.second.name}"
    seconds = f"{round((pair.window.end - pair.window.start) / 1e9, 6):.3g} s"
    if not found:
        ended = pair.first.timeline.ended
        failed = f"; it failed: {ended.reason}" if ended is not None and ended.failed else ""
        return f"✓ the same on both for {seconds}: {counts}{failed}\n"
    lines = [f"✗ not the same on both in {seconds}: {counts}"]
    for each in found[:_MOST]:
        at = f"  {timestamp(each.at):>9}  "
        lines.append(fill(each.what, 110, initial_indent=at, subsequent_indent=" " * len(at)))
    if len(found) > _MOST:
        lines.append(f"  and {len(found) - _MOST} more")
    return "".join(f"{line}\n" for line in lines)
