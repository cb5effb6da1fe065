"""Every command of the command line: its name, options, help and what carries it out."""

import argparse
from collections.abc import Callable
from functools import partial
from typing import Any

from cbtui.commands import (
    check,
    compare,
    completion,
    console,
    doctor,
    eject,
    explore,
    export,
    grade,
    info,
    keys,
    lint_lesson,
    listing,
    new,
    new_lesson,
    probe,
    prove,
    reset,
    robot,
    run,
    serve,
    start,
)
from cbtui.commands.options import appearance, more_lessons
from cbtui.commands.options.command_parser import CommandParser


def add_commands(parser: CommandParser, whole: Callable[[], argparse.ArgumentParser]) -> None:
    """Add all commands to a parser; ``whole`` builds one with all of them, for completion and manual page."""
    commands = parser.add_subparsers(title="commands", metavar="COMMAND")

    def command(
        name: str,
        add_options: Callable[[argparse.ArgumentParser], None],
        action: Callable[[argparse.Namespace], int],
        **texts: Any,
    ) -> CommandParser:
        own: CommandParser = commands.add_parser(name, **texts)
        add_options(own)
        own.set_defaults(action=action)
        return own

    command(
        "list",
        more_lessons.add_option,
        listing.list_lessons,
        help="list lessons and puzzles, with your progress",
    )
    opening = command(
        "open",
        console.add_open_options,
        console.open_console,
        help="open a lesson, a puzzle, or a file of your own, in the console",
        usage="%(prog)s [options] LESSON|PUZZLE|FILE.py [-- ARGUMENTS of the file]",
    )
    more_lessons.add_option(opening)
    command(
        "run",
        run.add_options,
        run.run,
        help="run a lesson, or files of your own, without the console",
        usage="%(prog)s [options] LESSON|FILE.py … [-- ARGUMENTS of the files]",
        description="Run a lesson, or node and launch files, headless: the log goes to stderr, a summary to "
        "stdout. Several files run at once, each as a process of its own would.",
        epilog="Exit status: 0 if the run came to its end, whatever it found; 1 if it failed, or with "
        "--fail-on problem if a problem was found; 2 if the command was wrong; 128 and its number if a "
        "signal ended it.",
    )
    command(
        "explore",
        explore.add_options,
        explore.explore,
        help="search for an order of threads in which a program fails",
        usage="%(prog)s [options] FILE.py|LESSON [-- ARGUMENTS of the file]",
        description="Run a program headless many times, each time in another order of its threads that a "
        "machine could come to: which of those that can run goes on, who gets a lock, where one is left for "
        "another. Ends with 0 if all went well, with 1 if some failed. Each order has a seed, and run, check "
        "and open show it again with --seed.",
    )
    command(
        "probe",
        probe.add_probe_options,
        probe.probe,
        help="run a command on real ROS 2 so that attach can watch it",
        usage="%(prog)s [--keep SECONDS] [--tcp PORT] -- COMMAND …",
        description="Run a command, such as python3 node.py or ros2 launch …, in which every process that "
        "imports rclpy can be watched with cbtui attach. The processes need nothing of cbtui's, and go on "
        "whether they are watched or not.",
    )
    command(
        "robot",
        robot.add_options,
        robot.robot,
        help="the lessons' robot as a real ROS 2 node",
        description="Drive the lessons' robot on your ROS graph, as your ROS_DOMAIN_ID and discovery say: "
        "/odom, /scan, /cmd_vel, /reset_world, /motor_power and, where tf2_msgs is installed, /tf. "
        "Any node on the network can drive it. Ctrl-C ends it.",
    )
    command(
        "attach", probe.add_attach_options, probe.attach, help="watch processes that cbtui probe has started"
    )
    command(
        "prove",
        prove.add_options,
        prove.prove,
        help="compare what a program does on the model and on real ROS 2",
        usage="%(prog)s [options] LESSON|FILE.py … [-- ARGUMENTS of the files]",
        description=prove.DESCRIPTION,
    )
    command("start", start.add_options, start.start, help="begin a lesson's exercise in a file of your own")
    command(
        "check",
        check.add_options,
        check.check,
        help="check your file for an exercise",
        description="Run your file on virtual time, or with --on ros2 on real ROS 2, and check whether it "
        "does what the exercise asks. Ends with 0 if it does, with 1 if not.",
    )
    command(
        "grade",
        grade.add_options,
        grade.grade,
        help="check the files of many learners",
        description=grade.DESCRIPTION,
    )
    command("reset", reset.add_options, reset.reset, help="forget your progress in a lesson")
    command("replay", console.add_replay_options, console.replay, help="show a recording in the console")
    command("info", info.add_options, info.info, help="summarise a recording")
    command(
        "compare",
        compare.add_options,
        compare.compare,
        help="put two runs side by side",
        usage="%(prog)s [options] A B [-- ARGUMENTS of a file]",
        description="Put the same window of two runs side by side: in the console, one above the other on a "
        "common time axis, with what differs; as text with --text or where there is no terminal. Lessons and "
        "files are run for that, headless on virtual time, or on real ROS 2. A lesson can be compared with "
        "itself, with other numbers of threads, or on the model and on real ROS 2.",
    )
    command(
        "export",
        export.add_options,
        export.export_command,
        help="turn a recording into a picture, a table, a report or a trace",
        usage="%(prog)s FILE.mcap --FORMAT OUT …",
    )
    command(
        "eject",
        eject.add_options,
        eject.eject,
        help="write the lessons' nodes as ROS 2 packages",
        description="Write each unit as an ament_python package into a folder, for colcon build and ros2 "
        "launch on a ROS 2 machine. The nodes are the lessons' own, word for word. Nothing is written where "
        "a file that you have changed is in the way.",
    )
    command(
        "serve",
        serve.add_options,
        serve.serve,
        help="show the console in a browser",
        usage="%(prog)s [options] [-- what cbtui open gets]",
        description="Show the console in a browser, each visitor one of their own. Without more it opens on "
        "the menu; what follows -- is opened as cbtui open would.",
    )
    command("new", new.add_options, new.new, help="write a small node of your own to begin with")
    command(
        "new-lesson",
        new_lesson.add_options,
        new_lesson.new_lesson,
        help="make a lesson of your own to begin with",
    )
    command(
        "lint-lesson",
        lint_lesson.add_options,
        lint_lesson.lint_lesson,
        help="prove that a lesson is right",
        description="Run a lesson's node, starter and solution, and check that all that its files say of "
        "them is true. Ends with 0 if it is.",
    )
    command(
        "doctor",
        doctor.add_options,
        doctor.examine,
        help="check whether this machine has what cbtui needs",
        description="Look at Python, PyBullet, the terminal, folders and files, and run an engine for a "
        "moment; nothing is changed. Ends with 0 if nothing is wrong, with 1 if something is.",
    )
    command(
        "keys",
        appearance.add_options,
        keys.print_keys,
        help="print every key, as a configuration to copy from",
    )
    command(
        "completion",
        completion.add_options,
        partial(completion.completion, whole),
        help="print the completion script for a shell",
        description="Print a script for a shell that completes commands, options, lessons and files: "
        'eval "$(cbtui completion bash)" in ~/.bashrc, the like in ~/.zshrc; cbtui completion fish | source.',
    )
    manual = commands.add_parser("man", help="print the manual page: cbtui man | man -l -")
    manual.set_defaults(action=partial(completion.man, whole))
    commands.add_parser("ros2", help="run a ros2 line in the run that is going on", add_help=False)
