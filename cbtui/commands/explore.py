"""``cbtui explore``: runs a program under other thread schedules and reports the outcomes."""

import argparse
import shlex
import sys
from contextlib import closing
from typing import TYPE_CHECKING

from cbtui.commands.check import add_limit, exercise_of
from cbtui.commands.options import changes, inputs, more_lessons, values
from cbtui.commands.options.targets import file_of, is_file_name, lesson_of, refuse
from cbtui.terminal.interrupts import INTERRUPTED
from cbtui.text.output import complain, say

if TYPE_CHECKING:
    from cbtui.runs.judged.exploring import Exploration, ScheduleResult
    from lessons.lesson import Lesson

DEFAULT_SECONDS = 10.0


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("target", metavar="FILE.py|LESSON", help="a file, or a lesson's id, see cbtui list")
    parser.add_argument(
        "--schedules", metavar="N", type=values.count, default=100, help="how many orders (%(default)s)"
    )
    parser.add_argument(
        "--seed", metavar="S", type=values.seed, default=1, help="the seed of the first order (%(default)s)"
    )
    parser.add_argument(
        "--for",
        dest="seconds",
        metavar="SECONDS",
        type=values.duration,
        help=f"how long each run lasts in its own time ({DEFAULT_SECONDS:g}; a lesson: as it says)",
    )
    inputs.add_options(parser)
    changes.add_options(parser)
    parser.add_argument("--check", metavar="LESSON", help="judge each run of the file by a lesson's checks")
    add_limit(parser, 60)
    more_lessons.add_option(parser)


def explore(options: argparse.Namespace) -> int:
    """Run a program under other schedules; returns the exit code: 0 if all went well, 1 if some failed.

    Ctrl-C ends it early with 130; the results so far are printed all the same.
    """
    _check(options)
    exploration, replays = _of_file(options) if is_file_name(options.target) else _of_lesson(options)
    from cbtui.runs.judged.exploration_text import exploration_text

    seeds = range(options.seed, options.seed + options.schedules)
    found: dict[int, ScheduleResult] = {}
    interrupted = False
    try:
        _explore(exploration, seeds, found)
    except KeyboardInterrupt:
        interrupted = True
        complain(f"interrupted: {len(found)} of {len(seeds)} schedules were tried")
    if found:
        say(exploration_text(exploration.name, dict(sorted(found.items())), replays))
    if interrupted:
        return INTERRUPTED
    return 0 if all(result.well for result in found.values()) else 1


def _check(options: argparse.Namespace) -> None:
    """Refuse options that contradict each other."""
    is_file = is_file_name(options.target)
    if options.check is not None and not is_file:
        refuse(f"a lesson is judged by its own checks; leave out --check {options.check}, or give a file")
    inputs.check(options, options.seconds or DEFAULT_SECONDS)
    if is_file and options.check is None:
        return
    if others := [name for name, given in _of_files_only(options).items() if given]:
        refuse(f"a lesson's checks are about the run that it describes; leave out {', '.join(others)}")
    if options.arguments:
        refuse("a lesson has its own arguments; leave out what stands behind --")


def _of_files_only(options: argparse.Namespace) -> dict[str, object]:
    """Options that would change the run that a lesson's checks are about."""
    return {
        "--for": options.seconds,
        "--call": options.calls,
        "--at": options.lines,
        "--threads": options.threads,
        "--group": options.groups,
        "--period": options.periods,
        "--sensor-rate": options.sensor_rate,
    }


def _of_file(options: argparse.Namespace) -> "tuple[Exploration, list[str]]":
    """The exploration of a file, and the commands that repeat one schedule."""
    path = file_of(options.target)
    if options.check is not None:
        lesson = exercise_of(options.check)
        words = ["cbtui", "check", lesson.id, options.target]
        return _judged(lesson, options, options.target), [shlex.join(words)]

    from cbtui.runs.judged.exploring import Exploration
    from cbtui.runs.setup.lesson_setup import RunRequest

    seconds = options.seconds or DEFAULT_SECONDS
    changed = changes.changes_of(options)
    request = RunRequest(
        files=[path],
        arguments=options.arguments,
        changes=changed,
        clock="virtual",
        seconds=seconds,
        calls=options.calls,
        lines=options.lines,
    )
    given = inputs.words(options.calls, options.lines)
    different = changes.words(changed)
    behind = ["--", *options.arguments] if options.arguments else []
    replays = [
        ["cbtui", "run", options.target, "--for", f"{seconds:.12g}", *given, *different, *behind],
        ["cbtui", "open", options.target, *different, *behind],
    ]
    return Exploration(request.setup(), path.name, None, options.limit), [
        shlex.join(each) for each in replays
    ]


def _of_lesson(options: argparse.Namespace) -> "tuple[Exploration, list[str]]":
    lesson = lesson_of(options.target)
    if lesson.setup.clock == "real":
        refuse(f"{lesson.id} runs on the real clock, where the machine alone chooses the order of threads")
    run = lesson.run
    words = ["cbtui", "run", lesson.id, "--for", f"{run.seconds:g}"]
    words += [] if run.threads is None else ["--threads", str(run.threads)]
    words += inputs.words(run.calls, sorted(run.lines))
    return _judged(lesson, options, None), [shlex.join(words), shlex.join(["cbtui", "open", lesson.id])]


def _judged(lesson: "Lesson", options: argparse.Namespace, file: str | None) -> "Exploration":
    """The exploration of a lesson's node, or of a file in its place, judged by the lesson's checks."""
    from cbtui.runs.judged.exploring import Exploration
    from cbtui.runs.setup.lesson_setup import setup_to_judge
    from lessons.judge import Judge

    judge = None if lesson.exercise is None else Judge(lesson)
    path = None if file is None else file_of(file)
    name = lesson.node_path.name if path is None else path.name
    return Exploration(setup_to_judge(lesson, path), name, judge, options.limit)


def _explore(exploration: "Exploration", seeds: range, found: "dict[int, ScheduleResult]") -> None:
    """Put the result of each seed into ``found``; progress is shown if standard error is a terminal."""
    tells = sys.stderr.isatty()
    try:
        with closing(exploration.results(seeds)) as results:
            for seed, result in results:
                found[seed] = result
                if tells:
                    failed = sum(not each.well for each in found.values())
                    sys.stderr.write(f"\r{len(found)} of {len(seeds)} schedules, {failed} failed ")
                    sys.stderr.flush()
    finally:
        if tells:
            sys.stderr.write("\r\033[K")
