"""Examines optional parts: an editor, the console in a browser, confinement, and an installed ROS 2."""

import re
import shlex
import shutil
import socket
import subprocess
from collections.abc import Iterator, Mapping
from importlib.metadata import distributions
from importlib.util import find_spec
from pathlib import Path

from cbtui.doctor.examination import Examination, note, well
from cbtui.doctor.requirements import requirements
from cbtui.text.installing import install_command

_PORT = 8000
"""The default port of ``cbtui serve``."""
_TRIED = 10.0
"""Limit of a trial of ``bwrap`` in seconds."""


def editor(environment: Mapping[str, str]) -> Examination:
    """Examine whether the user's editor is installed."""
    named = environment.get("VISUAL", "").strip() or environment.get("EDITOR", "").strip()
    if not named:
        return note(
            "editor", "none is named", "export EDITOR=nano or another, to open your code from the console"
        )
    try:
        program = shlex.split(named)[0]
    except ValueError:
        return note("editor", f"the quotes of {named} do not match", "set EDITOR again")
    if shutil.which(program, path=environment.get("PATH")) is None:
        return note("editor", f"{program} is not there", "set EDITOR to one that is")
    return well("editor", named)


def browser(port: int = _PORT) -> Examination:
    """Examine whether the console can be shown in a browser."""
    if find_spec("textual_serve") is None:
        return well("browser", f"left out; {install_command('cbtui[serve]')} brings cbtui serve")
    with socket.socket() as tried:
        tried.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            tried.bind(("127.0.0.1", port))
        except OSError:
            return note("browser", f"port {port} is in use", "give cbtui serve another with --port")
    return well("browser", f"cbtui serve can have port {port}")


def grading(bwrap: str | None) -> Examination:
    """Examine whether ``bwrap``, the program at that path, can confine what is graded."""
    at_risk = "so what cbtui grade runs can read, write and end whatever you can"
    elsewhere = "grade where it can do no harm"
    if bwrap is None:
        return note("grading", f"bwrap is not there, {at_risk}", f"install bubblewrap, or {elsewhere}")
    command = [bwrap, "--unshare-all", "--die-with-parent", "--ro-bind", "/", "/", "true"]
    try:
        tried = subprocess.run(command, capture_output=True, text=True, timeout=_TRIED, check=False)
        why = tried.stderr.strip().rpartition("\n")[2] if tried.returncode else ""
    except (OSError, subprocess.TimeoutExpired) as error:
        why = str(error)
    if why:
        return note("grading", f"bwrap does not work here ({why}), {at_risk}", elsewhere)
    return well("grading", "bwrap confines what cbtui grade runs")


def ros(environment: Mapping[str, str]) -> Iterator[Examination]:
    """Examine whether a real ROS 2 is installed beside cbtui's model of it."""
    distribution = environment.get("ROS_DISTRO")
    try:
        spec = find_spec("rclpy")
    except (ImportError, ValueError):
        spec = None
    installed = (re.fullmatch(r"ros-(\w+)-rclpy", each.name) for each in distributions())
    wheels = sorted({match[1] for match in installed if match is not None})
    if len(wheels) > 1:
        yield note(
            "ROS 2",
            f"the wheels of {' and '.join(wheels)} are in one Python, and have overwritten each other",
            "make a venv for each, and name its interpreter with --on ros2 --python EXE",
        )
    elif spec is not None:
        place = Path(spec.origin).parent if spec.origin else "this Python's path"
        less = "" if find_spec("tf2_msgs") else "; it has no tf2_msgs, so cbtui robot has no /tf"
        yield well("ROS 2", f"a real rclpy lies in {place}; --on ros2 runs programs on it{less}")
    elif distribution:
        yield well(
            "ROS 2",
            f"{distribution} is set up here, for another Python: name that with --on ros2 --python EXE",
        )
    elif requirements("ros") == requirements():
        yield well(
            "ROS 2",
            "none here, and none needed; no wheels of it fit this Python: --on ros2 takes --python EXE",
        )
    else:
        yield well(
            "ROS 2", f"none here, and none needed; {install_command('cbtui[ros]')} brings one for --on ros2"
        )
