"""``cbtui new``: writes a small node as a starting point for a program of one's own."""

import argparse
import keyword
import re
import shlex
import sys
from importlib.machinery import PathFinder
from importlib.util import find_spec
from pathlib import Path

from cbtui.commands.options.targets import refuse
from cbtui.text.output import say

_OF_ROS = re.compile(r"rclpy|launch|launch_ros|rosidl_runtime_py|\w+_(msgs|srvs|interfaces)(_py)?")
"""Packages of ROS 2 that the model stands in for where none is installed."""


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("file", metavar="FILE.py", help="a new file")


def new(options: argparse.Namespace) -> int:
    """Write the file; returns the exit code 0, or exits with 2 and one line if it cannot be written."""
    from lessons.catalogue import ROOT
    from sim.files.atomic import write_atomically

    path = Path(options.file)
    if path.suffix != ".py":
        refuse(f"{path} is not the name of a program: give one that ends in .py")
    if not path.stem.isidentifier() or keyword.iskeyword(path.stem):
        refuse(
            f"{path} could not be imported: a name is letters, digits (not first) and _, no word of Python's"
        )
    if _is_module(path.stem):
        refuse(f"{path} would hide the module {path.stem} from every program beside it: take another name")
    try:
        write_atomically(path, (ROOT / "own" / "node.py").read_bytes(), replace=False)
    except FileExistsError:
        refuse(f"{path} is there already: nothing was written")
    except OSError as error:
        refuse(f"{path} cannot be written: {error.strerror}")
    say(f"{path} is yours now: a timer, a subscription and a service.\n")
    say(f"See it run: {shlex.join(['cbtui', 'open', str(path)])}\n")
    return 0


def _is_module(name: str) -> bool:
    """Whether programs can import a module of that name: Python's, of ROS 2, or of an installed package."""
    if name in sys.stdlib_module_names or _OF_ROS.fullmatch(name) or find_spec(f"sim.ros_packages.{name}"):
        return True
    installed = [folder for folder in sys.path if folder.endswith("-packages")]
    return PathFinder.find_spec(name, installed) is not None
