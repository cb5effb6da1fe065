"""A machine on virtual instants, and a workspace with a package, for launch tests."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from sim.launch import LaunchRun, ProcessSpec
from sim.launch.machine import OnExit, OnOutput

SETUP = """
from setuptools import setup
import os
from glob import glob

package_name = 'unit5_pkg'

setup(
    name=package_name,
    packages=[package_name],
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/' + package_name]),
        (f'share/{package_name}', ['package.xml']),
        (os.path.join('share', package_name, 'launch'), glob('launch/*.launch.py')),
        (os.path.join('share', package_name, 'config'), glob('config/*.yaml')),
    ],
    entry_points={
        'console_scripts': [
            'exercise51 = unit5_pkg.exercise51:main',
            'exercise52 = unit5_pkg.exercise52:main',
        ],
    },
)
"""


def make_package(workspace: Path, name: str = "unit5_pkg") -> Path:
    """A package in the workspace's ``src``; its folder."""
    root = workspace / "src" / name
    for folder in (name, "launch", "config"):
        (root / folder).mkdir(parents=True)
    (root / "package.xml").write_text(
        f'<?xml version="1.0"?>\n<package format="3"><name>{name}</name></package>'
    )
    (root / "setup.py").write_text(SETUP.replace("unit5_pkg", name))
    (root / name / "exercise51.py").write_text("def main():\n    pass\n")
    (root / "config" / "speeds.yaml").write_text("/**:\n  ros__parameters:\n    speed: 0.5\n")
    return root


@dataclass
class FakeProcess:
    number: int
    spec: ProcessSpec | tuple[str, ...]
    on_exit: OnExit
    on_output: OnOutput
    stubborn: bool = False
    signals: list[str] = field(default_factory=list)

    def interrupt(self) -> None:
        self._take("SIGINT")

    def terminate(self) -> None:
        self._take("SIGTERM")

    def kill(self) -> None:
        self.signals.append("SIGKILL")
        self.on_exit(-9)

    def _take(self, signal: str) -> None:
        self.signals.append(signal)
        if not self.stubborn:
            self.on_exit(0)


@dataclass
class FakeMachine:
    said: list[str] = field(default_factory=list)
    processes: list[FakeProcess] = field(default_factory=list)
    stubborn: bool = False
    now: float = 0.0
    _agenda: list[tuple[float, Callable[[], None]]] = field(default_factory=list)

    def start_process(self, spec: ProcessSpec, on_exit: OnExit, on_output: OnOutput) -> FakeProcess:
        return self._begin(spec, on_exit, on_output)

    def run_line(self, label: str, words: Sequence[str], on_exit: OnExit, on_output: OnOutput) -> FakeProcess:
        return self._begin(tuple(words), on_exit, on_output)

    def _begin(
        self, what: ProcessSpec | tuple[str, ...], on_exit: OnExit, on_output: OnOutput
    ) -> FakeProcess:
        process = FakeProcess(len(self.processes) + 1, what, on_exit, on_output, self.stubborn)
        self.processes.append(process)
        return process

    def call_at(self, seconds_from_now: float, action: Callable[[], None]) -> None:
        self._agenda.append((self.now + seconds_from_now, action))

    def say(self, text: str, severity: str = "INFO", logger: str = "launch") -> None:
        self.said.append(f"[{severity}] [{logger}]: {text}")

    def pass_time(self, until: float) -> None:
        while due := sorted((each for each in self._agenda if each[0] <= until), key=lambda each: each[0]):
            self._agenda.remove(due[0])
            self.now = due[0][0]
            due[0][1]()
        self.now = until

    def spec(self, place: int = 0) -> ProcessSpec:
        found = self.processes[place].spec
        assert isinstance(found, ProcessSpec)
        return found


HEAD = """\
from launch import LaunchDescription
from launch.actions import *
from launch.conditions import *
from launch.event_handlers import *
from launch.events import Shutdown as ShutdownEvent
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import *
from launch_ros.actions import *
from launch_ros.parameter_descriptions import *
from launch_ros.substitutions import FindPackageShare
from ament_index_python.packages import get_package_share_directory
def node(**more):
    return Node(package='unit5_pkg', executable='exercise51', **more)
def generate_launch_description():
    return LaunchDescription(actions())
def actions():
"""
HEAD_LINES = HEAD.count("\n")


@dataclass
class Launched:
    run: LaunchRun
    machine: FakeMachine


def launch(root: Path, body: str, *arguments: str, stubborn: bool = False) -> Launched:
    """Start a launch file of the package whose function ``actions`` has this body."""
    file = root / "launch" / "test.launch.py"
    file.write_text(HEAD + "".join(f"    {line}\n" for line in body.splitlines()))
    machine = FakeMachine(stubborn=stubborn)
    run = LaunchRun(file, arguments, machine)
    run.start()
    return Launched(run, machine)
