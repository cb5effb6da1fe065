"""The options that change a program's set-up without touching its file."""

import argparse
import sys
from typing import TYPE_CHECKING

from cbtui.commands.options import values
from cbtui.commands.options.targets import refuse
from cbtui.text.installing import install_command

if TYPE_CHECKING:
    from cbtui.runs.setup.changes import CallbackPlace, Changes
    from sim.engine.setup import PhysicsChoice, RealRos


class NoRealRosError(Exception):
    """There is no real ROS 2 where one was asked for; the text is a sentence."""


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options to a command."""
    parser.add_argument(
        "--threads",
        metavar="N",
        type=values.threads,
        help="number of threads of the executor, instead of its own",
    )
    add_groups_and_periods(parser)
    parser.add_argument(
        "--sensor-rate",
        metavar="HZ",
        type=values.sensor_rate,
        help="how often a second the robot's sensors measure (20)",
    )
    add_physics(parser)
    add_distro(parser)


def add_groups_and_periods(parser: argparse.ArgumentParser, side: str = "") -> None:
    """Add ``--group`` and ``--period``, or ``--group-a`` and so on where two programs are run."""
    of_run = f" of {side[1:].upper()}" if side else ""
    parser.add_argument(
        f"--group{side}",
        dest=f"groups{side.replace('-', '_')}",
        metavar="CALLBACK=GROUP",
        type=values.group_change,
        action="append",
        default=[],
        help=f"put a callback{of_run} into another group: own, shared, reentrant or default; NODE:CALLBACK "
        "means one node's; may be given again",
    )
    parser.add_argument(
        f"--period{side}",
        dest=f"periods{side.replace('-', '_')}",
        metavar="CALLBACK=SECONDS",
        type=values.period_change,
        action="append",
        default=[],
        help=f"give the timer{of_run} that calls CALLBACK another period; may be given again",
    )


def add_distro(parser: argparse.ArgumentParser, side: str = "") -> None:
    """Add ``--distro``, or ``--distro-a`` and ``--distro-b`` where two programs are run."""
    from sim.releases.profile import Profile

    parser.add_argument(
        f"--distro{side}",
        metavar="RELEASE[@PATCH]",
        type=values.distro,
        help="the release whose rclpy the model is like: humble, jazzy, kilted, lyrical, also with a patch, "
        "as in jazzy@7.1.5; jazzy and kilted were run, humble and lyrical follow documentation and source, "
        f"not runs (what the lesson or the file says, else {Profile()})",
    )


def add_physics(parser: argparse.ArgumentParser) -> None:
    """Add ``--physics``."""
    parser.add_argument(
        "--physics",
        choices=("pybullet", "numpy"),
        help="what moves the robot (pybullet if it is installed, else numpy)",
    )


def physics_of(options: argparse.Namespace) -> "PhysicsChoice | None":
    """Return the physics that ``--physics`` asks for, None for the usual one."""
    from sim.engine.setup import PhysicsChoice

    return None if options.physics is None else PhysicsChoice(options.physics)


def add_on(parser: argparse.ArgumentParser, side: str = "") -> None:
    """Add the options on real ROS 2 to a command that can run programs on it.

    ``side`` ends their names where two programs are run: ``-a`` or ``-b``.
    """
    what = f"{side[1:].upper()}" if side else "the program"
    parser.add_argument(
        f"--on{side}",
        choices=("model", "ros2"),
        default="model",
        help=f"what runs {what}: cbtui's model of rclpy, or real ROS 2, on the real clock (model); there, "
        "ros2 lines and launch files are left to the command ros2 of a sourced ROS, or else to cbtui's own",
    )
    add_python(parser, f"with --on{side} ros2: the Python that has it", side)


def add_python(parser: argparse.ArgumentParser, what: str, side: str = "") -> None:
    """Add ``--python``, which ``what`` describes."""
    parser.add_argument(
        f"--python{side}",
        metavar="EXE",
        help=f"{what}, as /usr/bin/python3 once ROS is sourced (cbtui's own)",
    )


def add_traceback(parser: argparse.ArgumentParser) -> None:
    """Add ``--traceback`` to a command that shows what a program prints."""
    parser.add_argument(
        "--traceback",
        action="store_true",
        help="print whole tracebacks, with the frames of cbtui's model of rclpy",
    )


def changes_of(options: argparse.Namespace) -> "Changes":
    """Return the changes that the options make."""
    from cbtui.runs.setup.changes import Changes

    return Changes(
        options.threads,
        dict(options.groups),
        dict(options.periods),
        sensor_rate=options.sensor_rate,
        physics=physics_of(options),
        distro=options.distro,
    )


def real_ros_of(options: argparse.Namespace, side: str = "") -> "RealRos | None":
    """Return the real ROS 2 that ``--on`` asks for; exits with code 2 and one line if options contradict."""
    own = side.replace("-", "_")
    ground, chosen = (getattr(options, f"{name}{own}") for name in ("on", "python"))
    if ground == "model":
        if chosen is not None:
            refuse(f"--python{side} names the Python of a real ROS 2: give --on{side} ros2 with it")
        return None
    if getattr(options, "clock", None) == "virtual" or getattr(options, "seed", None) is not None:
        refuse("real ROS 2 runs on the real clock and in its own order: leave out --clock virtual and --seed")
    if getattr(options, f"distro{own}", None) is not None:
        refuse(
            f"a real ROS 2 is the release it is: leave out --distro{side}; "
            f"--python{side} names a Python with another"
        )
    return chosen_ros(chosen, side)


def chosen_ros(chosen: str | None, side: str = "") -> "RealRos":
    """Return the ROS 2 that ``--python`` names; exits with code 2 and one line if there is none."""
    try:
        return real_ros(chosen, f"--python{side}")
    except NoRealRosError as error:
        refuse(str(error))


def real_ros(chosen: str | None, option: str = "python") -> "RealRos":
    """Return the ROS 2 of a Python, None for cbtui's own; ``option`` is the option that names a Python.

    Raises:
        NoRealRosError: there is none.
    """
    import shutil

    from sim.engine.setup import RealRos

    python = chosen or sys.executable
    found = shutil.which(python)
    if found is None:
        raise NoRealRosError(f"{option} {python}: there is no such program")
    wheels = _wheels_of(found)
    if wheels is None:
        raise NoRealRosError(
            f"{python} has no rclpy; name a Python that has it with {option}, where ROS is sourced, or "
            f"give cbtui's own one: {install_command('cbtui[ros]')}"
        )
    if len(wheels) > 1:
        raise NoRealRosError(
            f"{python} has the wheels of {' and '.join(wheels)}, which have overwritten each other; "
            f"make a venv for each, and name its Python with {option}"
        )
    return RealRos(chosen or "")


def release_of(python: str) -> str | None:
    """Return the release of a Python's rclpy in the form of ``--distro``; None if it is unknown."""
    import subprocess

    from sim.real.programs import unbootstrapped
    from sim.releases.distros import UnknownProfileError
    from sim.releases.profile import Profile

    asked = [python or sys.executable, "-c", _RELEASE]
    environment = unbootstrapped(asked[0])
    said = subprocess.run(asked, check=False, capture_output=True, text=True, env=environment).stdout
    try:
        return str(Profile.named(said.strip()))
    except UnknownProfileError:
        return None


_RELEASE = """
import os
from importlib.metadata import distributions
names = {each.name.replace("_", "-"): each.version for each in distributions()}
wheels = [name.split("-")[1] for name in names if name.split("-")[::2] == ["ros", "rclpy"]]
print(f"{(wheels or [os.environ.get('ROS_DISTRO')])[0]}@{names.get('rclpy')}")
"""


_WHEELS = """
import re, sys
from importlib.metadata import distributions
from importlib.util import find_spec
found = (re.fullmatch("ros-([a-z]+)-rclpy", each.name.replace("_", "-")) for each in distributions())
print(*sorted({match[1] for match in found if match}))
sys.exit(find_spec("rclpy") is None)
"""


def _wheels_of(python: str) -> list[str] | None:
    """Return the releases of a Python's rclpy wheels, none for a sourced ROS 2; None without any rclpy."""
    import subprocess

    asked = subprocess.run([python, "-c", _WHEELS], check=False, capture_output=True, text=True)
    return None if asked.returncode else asked.stdout.split()


def seeded_changes_of(options: argparse.Namespace) -> "Changes":
    """Return the changes that the options make, with those of ``--seed``, ``--on`` and ``--traceback``."""
    from dataclasses import replace

    return replace(
        changes_of(options), seed=options.seed, real=real_ros_of(options), whole_tracebacks=options.traceback
    )


def words(changes: "Changes") -> list[str]:
    """Return the changes as words of a command line, without a seed."""
    said = [] if changes.threads is None else ["--threads", str(changes.threads)]
    for place, wish in changes.groups.items():
        said += ["--group", f"{_spelt(place)}={wish}"]
    for place, period in changes.periods.items():
        said += ["--period", f"{_spelt(place)}={period / 1e9:.9g}"]
    if changes.sensor_rate is not None:
        said += ["--sensor-rate", f"{changes.sensor_rate:g}"]
    if changes.physics is not None:
        said += ["--physics", changes.physics]
    return said if changes.distro is None else [*said, "--distro", changes.distro]


def _spelt(place: "CallbackPlace") -> str:
    node, callback = place
    return f"{node}:{callback}" if node else callback
