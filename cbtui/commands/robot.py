"""``cbtui robot``: the lessons' robot as a real ROS 2 node, for all programs on its ROS graph."""

import argparse
import math
import os
import shutil
import sys
import time
from importlib.util import find_spec
from typing import TYPE_CHECKING

from cbtui.commands.console import console_look, run_console
from cbtui.commands.options import changes, values
from cbtui.commands.options.appearance import add_options as add_appearance
from cbtui.commands.options.targets import refuse
from cbtui.commands.probe import probes_folder
from cbtui.text.installing import install_command
from cbtui.text.output import say

if TYPE_CHECKING:
    from sim.trace.events import RobotMoved

_PERIOD = 1.0
"""Seconds between two lines on the robot's position."""


def add_options(parser: argparse.ArgumentParser) -> None:
    """Give the command its arguments."""
    parser.add_argument(
        "--rate", metavar="HZ", type=values.sensor_rate, help="how often a second its sensors measure (20)"
    )
    parser.add_argument(
        "--map", action="store_true", help="open the console on it, and on what cbtui probe has started"
    )
    changes.add_physics(parser)
    add_appearance(parser)


def robot(options: argparse.Namespace) -> int:
    """Drive the robot until Ctrl-C, or while the console is open; returns the exit code."""
    if find_spec("rclpy") is None:
        refuse(
            f"the robot needs a rclpy in cbtui's own Python: {install_command('cbtui[ros]')}, "
            "or source a ROS 2 for this Python"
        )
    if options.map:
        from cbtui.runs.setup.shown_program import of_robot

        return run_console(
            console_look(options, "cbtui robot"),
            start_program=of_robot(probes_folder(), options.rate, changes.physics_of(options)),
        )
    from sim.real.robot import drive, transforms

    tf = transforms()
    topics = "/odom, /scan" if tf is None else "/odom, /scan, /tf"
    domain = os.environ.get("ROS_DOMAIN_ID", "0")
    say(f"a robot is on ROS domain {domain}; ctrl+c ends it\n")
    say(f"topics and services: {topics}, /cmd_vel, /reset_world, /motor_power\n")
    if tf is None:
        say("there is no /tf: that takes tf2_msgs, which no wheel has, but a sourced ROS 2 does\n")
    status = _Status()
    drive(status.take, options.rate, tf, changes.physics_of(options))
    status.end()
    return 0


class _Status:
    """Prints the robot's position once a second: in place on a terminal, elsewhere only when it changes."""

    def __init__(self) -> None:
        self._in_place = sys.stdout.isatty()
        self._next = 0.0
        self._shown = ""

    def take(self, report: object) -> None:
        """Receive a report of the robot."""
        from sim.trace.events import RobotMoved

        if isinstance(report, RobotMoved) and time.monotonic() >= self._next:
            self._next = time.monotonic() + _PERIOD
            self._show(_sentence(report))

    def end(self) -> None:
        """End the line that is printed in place."""
        if self._in_place and self._shown:
            say("\n")

    def _show(self, text: str) -> None:
        if self._in_place:
            text = text[: shutil.get_terminal_size().columns - 1]
            sys.stdout.write(f"\r{text.ljust(len(self._shown))}")
            sys.stdout.flush()
        elif text != self._shown:
            say(f"{text}\n")
        self._shown = text


def _sentence(robot: "RobotMoved") -> str:
    ahead = f"{robot.front:.2f} m ahead" if math.isfinite(robot.front) else "free ahead"
    said = [
        f"at {_rounded(robot.x)} {_rounded(robot.y)} m, {round(math.degrees(robot.yaw)) + 0} deg",
        f"{_rounded(robot.linear)} m/s, {_rounded(robot.angular)} rad/s",
        ahead,
    ]
    said += [] if robot.motors else ["motors off"]
    return "   ".join([*said, "touching"] if robot.touching else said)


def _rounded(figure: float) -> str:
    return f"{round(figure, 2) + 0.0:.2f}"
