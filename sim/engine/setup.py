"""The set-up of a run: its programs, its clock, its robot and its scheduled inputs."""

from enum import StrEnum

import msgspec

from sim.clock.schedule import Seed
from sim.robot.physics import PhysicsChoice as PhysicsChoice  # noqa: PLC0414 - handed on to the console


class RobotUse(StrEnum):
    """When a run has the lessons' robot."""

    ALWAYS = "always"
    WHEN_USED = "when used"
    """From the first use of one of its topics or services."""
    NEVER = "never"


class ServiceChoice(msgspec.Struct, frozen=True):
    """The SetBool service that the call key calls."""

    name: str
    type: str


class TimedCall(msgspec.Struct, frozen=True):
    """A SetBool call with ``data`` at ``at`` nanoseconds."""

    at: int
    data: bool


class TimedLine(msgspec.Struct, frozen=True):
    """A ``ros2`` line at ``at`` nanoseconds."""

    at: int
    text: str


class TimedText(msgspec.Struct, frozen=True):
    """Text that is typed at the terminal of the run's programs at ``at`` nanoseconds."""

    at: int
    text: str


class Keyboard(StrEnum):
    """The source of input at the terminal of a run's programs, besides the set-up's ``typed`` texts."""

    NOBODY = "nobody"
    """The input ends after the ``typed`` texts."""
    LIVE = "live"
    """A person may at any time; a run as fast as possible waits for them."""
    REPEATED = "repeated"
    """A person did in the run that this one repeats; the ``inputs`` have it."""


class TimedInput(msgspec.Struct, frozen=True):
    """An input of an earlier run, which is given at the end of moment ``at`` (nanoseconds).

    ``command`` is the text of ``sim.engine.commands.input_text``; ``recess`` is the recess, in a moment
    without end, in which the input was given, 0 for none.
    """

    at: int
    command: str
    recess: int = 0


class ProgramSetup(msgspec.Struct, frozen=True):
    """A Python file to run, a node's or a launch file, with its command-line arguments."""

    path: str
    arguments: tuple[str, ...] = ()

    @property
    def is_launch_file(self) -> bool:
        """Whether the file's name is that of a launch file."""
        return self.path.endswith(("launch.py", ".xml", ".yaml", ".yml"))


class GroupChange(msgspec.Struct, frozen=True):
    """Another callback group for one callback of a node ("": of any), by their names on the trace.

    ``wish`` is a value of ``sim.ros.middleware.callback_overrides.GroupChoice``. For an entity without a
    callback, ``callback`` is its topic or service.
    """

    node: str
    callback: str
    wish: str


class PeriodChange(msgspec.Struct, frozen=True):
    """Another period (nanoseconds) for the timers of a node ("": of any) that call ``callback``."""

    node: str
    callback: str
    period: int


class RealRos(msgspec.Struct, frozen=True):
    """A real ROS 2: that of the interpreter ``python``, "" for the interpreter that runs this.

    With ``watched``, a folder of probes' sockets, no program is run: the run shows ``processes``, by their
    ids, or all whose probes listen there. ``addresses`` are probes on the network, host and port each.
    """

    python: str = ""
    watched: str = ""
    processes: tuple[int, ...] = ()
    addresses: tuple[tuple[str, int], ...] = ()

    @property
    def is_watched(self) -> bool:
        """Whether the run shows programs that it has not started."""
        return bool(self.watched or self.addresses)


class RunSetup(msgspec.Struct, frozen=True, kw_only=True):
    """Everything that an engine needs to run some programs.

    A run without programs ends with its lines. A field is None or empty for the usual behaviour.

    - ``texts``: run in place of what the files of programs, and of modules that they import, hold; by path.
    - ``service``: the SetBool service of the call key; None: the first that a program offers.
    - ``speed``: seconds of the run per real second; None: as fast as possible, which on the real clock is 1.
    - ``until``: nanoseconds of run time after which the run ends; None: no end.
    - ``threads``: replaces the number of threads of the programs' executors.
    - ``lines``: numbered 1, 2, … on the trace.
    - ``inputs``: in the order of their moments, which the real clock keeps only approximately.
    - ``packages``: folders to search for packages, after those around the programs.
    - ``sensor_rate``: of the robot's odometry and scans, in Hz.
    - ``physics``: None: PyBullet if it is installed, else numpy.
    - ``groups``, ``periods``: changes of the programs' callbacks; of two for one callback the later counts.
    - ``contents``: whether the trace has the contents of published messages.
    - ``seed``: chooses among possible orders of threads on the virtual clock, from ``explored_from``
      (nanoseconds) on; None and 0: first come, first served.
    - ``whole_tracebacks``: whether tracebacks have the frames of the model.
    - ``real``: runs the programs on real rclpy, in processes of their own, on the real clock.
    - ``distro``: the modelled release of rclpy, as in ``sim.releases``; "": that of the programs' comments,
      or the usual one.
    - ``seal``: the key that seals the trace (``sim.trace.integrity.sealing``); b"": no seal.
    """

    title: str
    programs: tuple[ProgramSetup, ...]
    texts: dict[str, str] = {}
    service: ServiceChoice | None = None
    clock: str = "virtual"
    speed: float | None = 1.0
    until: int | None = None
    threads: int | None = None
    calls: tuple[TimedCall, ...] = ()
    lines: tuple[TimedLine, ...] = ()
    typed: tuple[TimedText, ...] = ()
    keyboard: Keyboard = Keyboard.NOBODY
    inputs: tuple[TimedInput, ...] = ()
    packages: tuple[str, ...] = ()
    robot: RobotUse = RobotUse.ALWAYS
    sensor_rate: float | None = None
    physics: PhysicsChoice | None = None
    groups: tuple[GroupChange, ...] = ()
    periods: tuple[PeriodChange, ...] = ()
    contents: bool = False
    seed: Seed | None = None
    explored_from: int = 0
    whole_tracebacks: bool = False
    real: RealRos | None = None
    distro: str = ""
    seal: bytes = b""
