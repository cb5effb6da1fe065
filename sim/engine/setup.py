"""What a run is set up with: its programs, its clock, its robot and the inputs it is to get."""

from enum import StrEnum

import msgspec

from sim.clock.schedule import Seed
from sim.robot.physics import PhysicsChoice as PhysicsChoice  # noqa: PLC0414 - handed on to the console


class RobotUse(StrEnum):
    """When the lessons' robot is there."""

    ALWAYS = "always"
    WHEN_USED = "when used"
    """From the moment at which something uses one of its topics or services."""
    NEVER = "never"


class ServiceChoice(msgspec.Struct, frozen=True):
    """The SetBool service that the call key fires."""

    name: str
    type: str


class TimedCall(msgspec.Struct, frozen=True):
    """A SetBool call to be made at ``at`` nanoseconds with ``data``."""

    at: int
    data: bool


class TimedLine(msgspec.Struct, frozen=True):
    """A ``ros2`` line to be carried out at ``at`` nanoseconds."""

    at: int
    text: str


class TimedText(msgspec.Struct, frozen=True):
    """Text to be typed at the terminal of the run's programs at ``at`` nanoseconds."""

    at: int
    text: str


class Keyboard(StrEnum):
    """Who types at the terminal of a run's programs, besides what is ``typed`` by the set-up."""

    NOBODY = "nobody"
    """The input ends behind what is ``typed``."""
    LIVE = "live"
    """Somebody may at any time; a run that goes as fast as it can waits for him."""
    REPEATED = "repeated"
    """Somebody did, in the run that this one repeats: it is among the ``inputs``."""


class TimedInput(msgspec.Struct, frozen=True):
    """An input of a run of before, to be carried out at the end of moment ``at`` (nanoseconds).

    ``command`` is what ``sim.engine.commands.input_text`` makes of it, ``recess`` which recess of a moment
    that did not end it was given in, 0 for none.
    """

    at: int
    command: str
    recess: int = 0


class ProgramSetup(msgspec.Struct, frozen=True):
    """A Python file to run, a node's or a launch file, with its command-line arguments.

    ``text`` is run in place of the node's file, "" for what the file holds.
    """

    path: str
    arguments: tuple[str, ...] = ()
    text: str = ""

    @property
    def is_launch_file(self) -> bool:
        """Whether it is a file for ``ros2 launch``, by its name."""
        return self.path.endswith(("launch.py", ".xml", ".yaml", ".yml"))


class GroupChange(msgspec.Struct, frozen=True):
    """Another callback group for one callback of a node ("": of any), by their names on the trace.

    ``wish`` is a value of ``sim.ros.middleware.callback_overrides.GroupChoice``. For what has no callback,
    ``callback`` is its topic or service.
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
    """A real ROS 2: the one that the interpreter ``python`` has, "" for the one that runs this.

    With ``watched``, a folder of probes' sockets, nothing is run: what ``processes`` do is shown (numbers of
    the operating system), or what all do whose probes listen there. The same for ``addresses``, host and port
    each.
    """

    python: str = ""
    watched: str = ""
    processes: tuple[int, ...] = ()
    addresses: tuple[tuple[str, int], ...] = ()

    @property
    def is_watched(self) -> bool:
        """Whether others have started what is shown."""
        return bool(self.watched or self.addresses)


class RunSetup(msgspec.Struct, frozen=True, kw_only=True):
    """All that an engine needs to know to run some programs.

    ``speed`` is seconds of the run per real second, None for as fast as it can: on the real clock that is 1.
    ``until`` is nanoseconds of run time after which the run ends, None for no end. ``threads`` replaces
    the number of threads of the programs' executors, None leaves their own. ``service`` None means the
    first SetBool service that a program offers. ``lines`` get the numbers 1, 2, … on the trace.
    ``packages`` are folders in which packages are looked for, after those around the programs. A run
    without programs ends with its lines. ``inputs`` are in the order of their moments; the real clock
    gives them as near to those as the machine can. ``groups`` and ``periods`` change the programs'
    callbacks, the later of two changes of one callback counts. ``sensor_rate`` (Hz) is that of the
    robot's odometry and scans, None leaves the usual one;
    ``physics`` None is PyBullet if it is installed, else numpy. With ``contents``
    the trace has what published messages hold. ``seed`` chooses,
    on the virtual clock, among the orders in which a machine could run threads; None and 0 are first come,
    first served; up to ``explored_from`` (nanoseconds) they run so in any case. Tracebacks are without the
    frames of the model, unless they are to be ``whole_tracebacks``.
    With ``real`` the programs run on real rclpy, in processes of their own, and on the real clock.
    ``distro`` is the release of rclpy that the model is like, as ``sim.releases`` spells it, "" for what
    its programs ask for, or the usual one. ``seal`` is the key that its trace is sealed with
    (``sim.trace.integrity.sealing``), b"" for none.
    """

    title: str
    programs: tuple[ProgramSetup, ...]
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
