"""The ``cbtui`` command: opens the console, lists lessons, runs them headless.

Whatever a command needs is imported when it runs: ``cbtui --help`` must answer at once.
"""

import argparse
import math
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

from cbtui import export_command

if TYPE_CHECKING:
    from lessons.lesson import Lesson
    from sim.engine.setup import RunSetup

_MAX_THREADS = 64
_DEFAULT_SECONDS = 60.0
_CHARSETS = ("braille", "block", "ascii")


class _TimedLine(argparse.Action):
    """Takes a moment in seconds and a ``ros2`` line."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: Any,
        option_string: str | None = None,
    ) -> None:
        """Add the pair to those given before."""
        moment, line = values
        try:
            pair = (_moment(moment), line)
        except argparse.ArgumentTypeError as error:
            raise argparse.ArgumentError(self, str(error)) from None
        setattr(namespace, self.dest, [*getattr(namespace, self.dest), pair])


class _Parser(argparse.ArgumentParser):
    """A parser whose complaints are one line."""

    def error(self, message: str) -> NoReturn:
        """Say what was wrong and where to read more, and exit with 2."""
        self.exit(2, f"{self.prog}: {message} (see {self.prog} --help)\n")


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code: 0 well, 1 the run failed, 2 the command was wrong."""
    words = list(sys.argv[1:] if argv is None else argv)
    if words[:1] == ["ros2"]:
        return _ros2(words[1:])
    split = words.index("--") if "--" in words else len(words)
    options = _parser().parse_args(words[:split])
    options.arguments = words[split + 1 :]
    action: Callable[[argparse.Namespace], int] = options.action
    return action(options)


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="cbtui",
        description="A terminal teaching console for ROS 2 callback groups and executors.",
        epilog="Without a command the console opens on its menu of lessons.",
    )
    parser.add_argument("--version", action="version", version=f"cbtui {_version()}")
    _add_console_options(parser)
    parser.set_defaults(action=_open_console, target=None, clock="real")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND")

    listing = commands.add_parser("list", help="list the lessons")
    listing.set_defaults(action=_list)

    opening = commands.add_parser(
        "open",
        help="open a lesson, or a file of your own, in the console",
        usage="%(prog)s [options] LESSON|FILE.py [-- ARGUMENTS of the file]",
    )
    opening.add_argument("target", metavar="LESSON|FILE.py", help="a lesson's id, see cbtui list, or a file")
    _add_console_options(opening)
    opening.add_argument(
        "--clock", choices=("virtual", "real"), default="real", help="which time a file runs on (%(default)s)"
    )
    opening.set_defaults(action=_open_console)

    running = commands.add_parser(
        "run",
        help="run a lesson, or files of your own, without the console",
        usage="%(prog)s [options] LESSON|FILE.py … [-- ARGUMENTS of the files]",
        description="Run a lesson, or node and launch files, headless: the log goes to stderr, a summary to "
        "stdout. Several files run at once, each as a process of its own would.",
    )
    _add_run_options(running)
    running.set_defaults(action=_run)

    replaying = commands.add_parser("replay", help="show a recording in the console")
    replaying.add_argument("recording", metavar="FILE.mcap", help="a recording that cbtui made")
    _add_console_options(replaying)
    replaying.set_defaults(action=_replay)

    informing = commands.add_parser("info", help="tell what is in a recording")
    informing.add_argument("recording", metavar="FILE.mcap", help="a recording that cbtui made")
    informing.set_defaults(action=_info)

    comparing = commands.add_parser(
        "compare",
        help="put two runs side by side",
        description="Put the same window of two runs side by side. Lessons and files are run for that, "
        "headless on virtual time.",
    )
    _add_compare_options(comparing)
    comparing.set_defaults(action=_compare)

    exporting = commands.add_parser(
        "export",
        help="take a recording to trace viewers, spreadsheets and paper",
        usage="%(prog)s FILE.mcap --FORMAT OUT …",
    )
    export_command.add_options(exporting, _moment)
    exporting.set_defaults(action=export_command.export_command)

    commands.add_parser("ros2", help="carry out a ros2 line in the run that is going on", add_help=False)
    return parser


def _add_console_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--charset", choices=_CHARSETS, default="braille", help="what the screen is drawn with (%(default)s)"
    )


def _add_run_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "targets",
        metavar="LESSON|FILE.py",
        nargs="*",
        help="a lesson's id, see cbtui list, or node files or a launch file",
    )
    parser.add_argument(
        "--for",
        dest="seconds",
        metavar="SECONDS",
        type=_duration,
        help=f"how long the run lasts in its own time ({_DEFAULT_SECONDS:g})",
    )
    parser.add_argument(
        "--threads", metavar="N", type=_threads, help="number of threads of the executor, instead of its own"
    )
    parser.add_argument(
        "--call",
        dest="calls",
        metavar="SECONDS",
        type=_moment,
        action="append",
        default=[],
        help="call the SetBool service at that time; may be given again",
    )
    parser.add_argument(
        "--call-data", choices=("true", "false"), default="true", help="what the calls send (%(default)s)"
    )
    parser.add_argument(
        "--at",
        dest="lines",
        metavar=("SECONDS", "LINE"),
        nargs=2,
        action=_TimedLine,
        default=[],
        help="carry out a ros2 line at that time, such as 2 'ros2 topic list'; may be given again",
    )
    parser.add_argument(
        "--inputs",
        metavar="FILE.mcap",
        help="give the run what a recorded one was given, at the same moments; without LESSON: repeat it",
    )
    parser.add_argument("--no-robot", dest="robot", action="store_false", help="leave out the lessons' robot")
    parser.add_argument(
        "--clock", choices=("virtual", "real"), help="which time it runs on (virtual; a file: real)"
    )
    parser.add_argument(
        "--speed",
        metavar="X",
        type=_speed,
        default=math.inf,
        help="seconds of the run per real second, or max (max; on the real clock 1)",
    )
    parser.add_argument("--events", metavar="FILE.jsonl", help="write every event as a line of JSON")
    parser.add_argument(
        "--record",
        metavar="FILE.mcap",
        help="record the run, with its topics as rosbag2 and Foxglove read them",
    )
    parser.add_argument(
        "--force", action="store_true", help="let --record replace a file that is there already"
    )


def _add_compare_options(parser: argparse.ArgumentParser) -> None:
    for name in ("A", "B"):
        parser.add_argument(name, help="a recording (.mcap), a lesson's id, or a node file")
    parser.add_argument(
        "--from",
        dest="start",
        metavar="SECONDS",
        type=_moment,
        default=0.0,
        help="where to begin (%(default)g)",
    )
    parser.add_argument(
        "--to",
        dest="end",
        metavar="SECONDS",
        type=_duration,
        help=f"where to end (where the shorter recording does; {_DEFAULT_SECONDS:g} where there is none)",
    )
    parser.add_argument(
        "--call",
        dest="calls",
        metavar="SECONDS",
        type=_moment,
        action="append",
        default=[],
        help="call the SetBool service of what is run at that time; may be given again",
    )


def _number(text: str, what: str) -> float:
    try:
        number = float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number; give {what}") from None
    if not math.isfinite(number):
        raise argparse.ArgumentTypeError(f"{text!r} is not a finite number; give {what}")
    return number


def _duration(text: str) -> float:
    seconds = _number(text, "seconds, such as 60")
    if seconds <= 0:
        raise argparse.ArgumentTypeError(f"a run cannot last {text} seconds; give more than 0")
    return seconds


def _moment(text: str) -> float:
    seconds = _number(text, "seconds, such as 2.55")
    if seconds < 0:
        raise argparse.ArgumentTypeError(f"{text} s is before the run begins; give 0 or more")
    return seconds


def _threads(text: str) -> int:
    try:
        threads = int(text)
    except ValueError:
        sentence = f"{text!r} is not a whole number; give 1 to {_MAX_THREADS}"
        raise argparse.ArgumentTypeError(sentence) from None
    if not 1 <= threads <= _MAX_THREADS:
        raise argparse.ArgumentTypeError(
            f"an executor cannot have {threads} threads here; give 1 to {_MAX_THREADS}"
        )
    return threads


def _speed(text: str) -> float:
    if text == "max":
        return math.inf
    speed = _number(text, "a factor such as 2, or max")
    if speed <= 0:
        raise argparse.ArgumentTypeError(f"time cannot pass {text} times as fast; give more than 0, or max")
    return speed


def _version() -> str:
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("cbtui")
    except PackageNotFoundError:
        return "(not installed)"


def _lesson(name: str) -> "Lesson":
    """The lesson of that id; an unknown one ends the program with one line and 2."""
    from lessons.catalogue import UnknownLesson, find

    try:
        return find(name)
    except UnknownLesson as error:
        _refuse(str(error))


def _refuse(sentence: str) -> NoReturn:
    sys.stderr.write(f"cbtui: {sentence}\n")
    raise SystemExit(2)


def _list(_options: argparse.Namespace) -> int:
    from lessons.catalogue import lessons

    known = lessons()
    width = max(len(lesson.id) for lesson in known)
    for lesson in known:
        sys.stdout.write(f"{lesson.number}  {lesson.id:{width}}  {lesson.title}: {lesson.executor}\n")
    return 0


def _open_console(options: argparse.Namespace) -> int:
    target: str | None = options.target
    start_file, lesson = None, None
    if target is not None and _is_file_name(target):
        start_file = (_file(target), options.arguments, options.clock)
    elif target is not None:
        lesson = _lesson(target).id
    _need_terminal("cbtui run")
    from cbtui.app import CbtuiApp

    CbtuiApp(charset=options.charset, start_lesson=lesson, start_file=start_file).run()
    return 0


def _replay(options: argparse.Namespace) -> int:
    from sim.trace.recording import RecordingError, read

    try:
        recording = read(Path(options.recording))
    except (RecordingError, ValueError) as error:
        _refuse(str(error))
    _need_terminal("cbtui info")
    from cbtui.app import CbtuiApp

    CbtuiApp(charset=options.charset, start_recording=recording).run()
    return 0


def _need_terminal(instead: str) -> None:
    if not (sys.stdin.isatty() and sys.stdout.isatty()):
        _refuse(f"the console needs a terminal; use {instead} where there is none")


def _run(options: argparse.Namespace) -> int:
    if options.inputs is not None:
        return _repeat(options)
    if not options.targets:
        _refuse("run needs a LESSON or a FILE.py; cbtui list lists the lessons")
    options.seconds = options.seconds or _DEFAULT_SECONDS
    is_file = _is_file_name(options.targets[0])
    clock = options.clock or ("real" if is_file else "virtual")
    _check_run(options, is_file=is_file)
    paths = [_file(name) for name in options.targets] if is_file else []
    lesson = None if is_file else _lesson(options.targets[0])

    import msgspec

    from cbtui.headless import run_headless
    from cbtui.lesson_setup import setup_for, setup_for_files
    from sim.engine.setup import RobotUse

    speed = None if options.speed == math.inf else options.speed
    if lesson is not None:
        program = setup_for(lesson, threads=options.threads, speed=speed)
    else:
        program = setup_for_files(paths, options.arguments, threads=options.threads, speed=speed)
    robot = program.robot if options.robot else RobotUse.NEVER
    return run_headless(
        msgspec.structs.replace(program, clock=clock, robot=robot),
        seconds=options.seconds,
        calls=options.calls,
        call_data=options.call_data == "true",
        lines=options.lines,
        events_path=options.events,
        recording_path=options.record,
        replace_recording=options.force,
    )


def _repeat(options: argparse.Namespace) -> int:
    """Run with the inputs of a recording."""
    if options.clock == "real":
        _refuse("only runs on the virtual clock can be repeated exactly; leave out --clock real")
    if options.calls or options.lines:
        _refuse("--inputs gives the run all its inputs; leave out --call and --at")
    if options.force and options.record is None:
        _refuse("--force lets --record replace a file; there is nothing to record to")
    import msgspec

    from cbtui.headless import run_set_up
    from cbtui.repeat import CannotRepeatError, repeated
    from sim.engine.setup import RobotUse

    speed = None if options.speed == math.inf else options.speed
    program = _program(options, speed) if options.targets else None
    try:
        setup = repeated(Path(options.inputs), program, seconds=options.seconds, threads=options.threads)
    except CannotRepeatError as error:
        _refuse(str(error))
    if not options.robot:
        setup = msgspec.structs.replace(setup, robot=RobotUse.NEVER)
    return run_set_up(
        msgspec.structs.replace(setup, speed=speed, contents=setup.contents or options.record is not None),
        events_path=options.events,
        recording_path=options.record,
        replace_recording=options.force,
    )


def _program(options: argparse.Namespace, speed: float | None) -> "RunSetup":
    """The set-up of the targets."""
    from cbtui.lesson_setup import setup_for, setup_for_files

    if not _is_file_name(options.targets[0]):
        if len(options.targets) > 1:
            _refuse("one lesson runs at a time; several targets must all be files")
        return setup_for(_lesson(options.targets[0]), threads=options.threads, speed=speed)
    paths = [_file(name) for name in options.targets]
    return setup_for_files(paths, options.arguments, threads=options.threads, speed=speed)


def _info(options: argparse.Namespace) -> int:
    from cbtui.info import tell

    return tell(Path(options.recording))


def _compare(options: argparse.Namespace) -> int:
    from cbtui.compare import Contender, compare_runs
    from cbtui.lesson_setup import setup_for, setup_for_files

    def contender(name: str) -> Contender:
        if name.endswith(".mcap"):
            return Contender(name, Path(name))
        if _is_file_name(name):
            return Contender(name, setup_for_files([_file(name)]))
        return Contender(name, setup_for(_lesson(name)))

    return compare_runs(
        contender(options.A),
        contender(options.B),
        start=options.start,
        end=options.end,
        calls=options.calls,
    )


def _ros2(words: list[str]) -> int:
    """Carry out a ros2 line; ``--engine PID`` in front of it chooses among several runs."""
    process = None
    if words[:1] == ["--engine"]:
        if len(words) < 2 or not words[1].isdecimal():
            _refuse("--engine needs the process number of a cbtui run")
        process, words = int(words[1]), words[2:]
    from cbtui.ros2_command import run_line

    return run_line(words, process)


def _check_run(options: argparse.Namespace, *, is_file: bool) -> None:
    """Refuse what does not fit together."""
    moments = [("call", at) for at in options.calls] + [("line", at) for at, _ in options.lines]
    for what, at in moments:
        if at >= options.seconds:
            _refuse(f"a {what} at {at:g} s comes when the run of {options.seconds:g} s is over; see --for")
    if not is_file and len(options.targets) > 1:
        _refuse("one lesson runs at a time; several targets must all be files")
    if options.force and options.record is None:
        _refuse("--force lets --record replace a file; there is nothing to record to")
    if options.arguments and not is_file:
        _refuse("a lesson has its own arguments; leave out what stands behind --")


def _is_file_name(target: str) -> bool:
    return target.endswith((".py", ".xml", ".yaml", ".yml")) or "/" in target


def _file(name: str) -> Path:
    """The program file of that name; one that is not there ends the program with one line and 2."""
    path = Path(name)
    if path.is_dir():
        _refuse(f"{name} is a folder; name the file in it that is to run")
    if not path.is_file():
        _refuse(f"there is no file {name}; give a Python file, or a lesson of cbtui list")
    return path
