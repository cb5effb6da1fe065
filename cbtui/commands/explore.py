"""``cbtui explore``: runs a program in other orders of its threads, and tells what comes of them."""

import argparse
import shlex
import sys
from typing import TYPE_CHECKING

from cbtui.commands import more_lessons, values
from cbtui.commands.check import add_limit, exercise_of
from cbtui.commands.output import say
from cbtui.commands.targets import file_of, is_file_name, lesson_of, refuse

if TYPE_CHECKING:
    from cbtui.exploring import Exploration, Result
    from lessons.lesson import Lesson

DEFAULT_SECONDS = 10.0
_SECOND = 1_000_000_000


def add_options(parser: argparse.ArgumentParser) -> None:
    """Give the command its arguments."""
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
    parser.add_argument(
        "--call",
        dest="calls",
        metavar="SECONDS",
        type=values.moment,
        action="append",
        default=[],
        help="call the SetBool service at that time; may be given again",
    )
    parser.add_argument("--check", metavar="LESSON", help="judge each run of the file by a lesson's checks")
    add_limit(parser, 60)
    more_lessons.add_option(parser)


def explore(options: argparse.Namespace) -> int:
    """Run other orders of a program; returns the exit code: 0 all went well, 1 some failed."""
    _check(options)
    exploration, replays = _of_file(options) if is_file_name(options.target) else _of_lesson(options)
    from cbtui.exploration_text import exploration_text

    seeds = range(options.seed, options.seed + options.schedules)
    found = _explored(exploration, seeds)
    say(exploration_text(exploration.name, found, replays))
    return 0 if all(result.well for result in found.values()) else 1


def _check(options: argparse.Namespace) -> None:
    """Refuse what does not fit together."""
    is_file = is_file_name(options.target)
    if options.check is not None and not is_file:
        refuse(f"a lesson is judged by its own checks; leave out --check {options.check}, or give a file")
    if (options.check is not None or not is_file) and (options.seconds is not None or options.calls):
        refuse("a lesson's checks are about the run that it describes; leave out --for and --call")
    if options.arguments and (options.check is not None or not is_file):
        refuse("a lesson has its own arguments; leave out what stands behind --")
    seconds = options.seconds or DEFAULT_SECONDS
    for at in options.calls:
        if at >= seconds:
            refuse(f"a call at {at:g} s comes when the run of {seconds:g} s is over; see --for")


def _of_file(options: argparse.Namespace) -> "tuple[Exploration, list[str]]":
    """What is to be run, and the commands that show one order again."""
    path = file_of(options.target)
    if options.check is not None:
        lesson = exercise_of(options.check)
        words = ["cbtui", "check", lesson.id, options.target]
        return _judged(lesson, options, options.target), [shlex.join(words)]

    import msgspec

    from cbtui.exploring import Exploration
    from cbtui.lesson_setup import setup_for_files
    from sim.engine.setup import TimedCall

    seconds = options.seconds or DEFAULT_SECONDS
    setup = msgspec.structs.replace(
        setup_for_files([path], options.arguments, speed=None),
        clock="virtual",
        until=round(seconds * _SECOND),
        calls=tuple(TimedCall(round(at * _SECOND), data=True) for at in sorted(options.calls)),
    )
    calls = [word for at in options.calls for word in ("--call", f"{at:g}")]
    behind = ["--", *options.arguments] if options.arguments else []
    replays = [
        ["cbtui", "run", options.target, "--for", f"{seconds:g}", *calls, *behind],
        ["cbtui", "open", options.target, *behind],
    ]
    return Exploration(setup, path.name, None, options.limit), [shlex.join(each) for each in replays]


def _of_lesson(options: argparse.Namespace) -> "tuple[Exploration, list[str]]":
    lesson = lesson_of(options.target)
    if lesson.setup.clock == "real":
        refuse(f"{lesson.id} runs on the real clock, where the machine alone chooses the order of threads")
    run = lesson.run
    words = ["cbtui", "run", lesson.id, "--for", f"{run.seconds:g}"]
    words += [] if run.threads is None else ["--threads", str(run.threads)]
    words += [word for at in sorted(run.calls) for word in ("--call", f"{at:g}")]
    words += [word for at, line in sorted(run.lines) for word in ("--at", f"{at:g}", line)]
    return _judged(lesson, options, None), [shlex.join(words), shlex.join(["cbtui", "open", lesson.id])]


def _judged(lesson: "Lesson", options: argparse.Namespace, file: str | None) -> "Exploration":
    """A lesson's node, or a file in its place, judged by the lesson's checks if it has any."""
    from cbtui.checking import setup_to_judge
    from cbtui.exploring import Exploration
    from lessons.judge import Judge

    judge = None if lesson.exercise is None else Judge(lesson)
    path = None if file is None else file_of(file)
    name = lesson.node_path.name if path is None else path.name
    return Exploration(setup_to_judge(lesson, path), name, judge, options.limit)


def _explored(exploration: "Exploration", seeds: range) -> "dict[int, Result]":
    """What came of each seed, in the order of the seeds; how far it has come shows on a terminal."""
    tells = sys.stderr.isatty()
    found = {}
    for seed, result in exploration.results(seeds):
        found[seed] = result
        if tells:
            failed = sum(not each.well for each in found.values())
            sys.stderr.write(f"\r{len(found)} of {len(seeds)} schedules, {failed} failed ")
            sys.stderr.flush()
    if tells:
        sys.stderr.write("\r\033[K")
    return dict(sorted(found.items()))
