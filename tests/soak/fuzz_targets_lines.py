"""Targets that read lines: of the prompt, of a command line, of a log."""

from contextlib import redirect_stderr, suppress
from functools import cache
from io import StringIO
from pathlib import Path

from cbtui.looks.theme import Charset
from cbtui.text.cells import fit, visible, without_tabs
from cbtui.widgets.log.filter import FilterError, filter_of
from cbtui.widgets.log.line import line_of
from sim.clock import PacedClock
from sim.interfaces import message
from sim.launch.arguments import read_arguments
from sim.launch.errors import LaunchError
from sim.packages import Packages
from sim.probes.probe import SilentProbe
from sim.ros.context.arguments import ArgumentsError, parse_arguments
from sim.ros.context.context import Context
from sim.ros.logging.console import LogConsole
from sim.ros.logging.filters import CallSite
from sim.ros.logging.record import LogRecord
from sim.ros.logging.severity import LoggingSeverity
from sim.ros.middleware.host import Host
from sim.ros.node.node import Node
from sim.shell import complete, word_start
from sim.shell.commands import parse, verb_parser
from sim.shell.model_ground import ModelGround
from sim.shell.parser import HelpAsked, UsageError
from sim.shell.splitting import LineError, split
from sim.trace.events import Logged, Severity
from tests.soak.fuzz_target import Target, text_of

_LINES = (
    b"ros2 topic pub -r 10 /cmd_vel geometry_msgs/msg/Twist '{linear: {x: 0.5}}'",
    b"ros2 topic echo /odom --qos-reliability best_effort --once",
    b'ros2 service call /motor_power std_srvs/srv/SetBool "{data: true}"',
    b"ros2 param set /turtle speed 2.5",
    b"ros2 action send_goal /f example_interfaces/action/Fibonacci 'order: 5' --feedback",
    b"$ ros2 run unit5_pkg exercise51 --ros-args -p a:=1 # and so on",
    b"ros2 launch unit5_pkg exercise51.launch.py x:=1 --show-args",
    b"ros2 interface show std_msgs/msg/String",
    b"ros2 node info /turtle",
)
_WORDS = (
    b"ros2 ",
    b"topic ",
    b"pub ",
    b"--",
    b"-",
    b"-r ",
    b"-h",
    b"/cmd_vel ",
    b"/",
    b"$(x)",
    b";",
    b"|",
    b"`",
    b"~",
)


def prompt() -> Target:
    """Lines of the prompt, split and understood; nothing is carried out."""
    return Target("prompt", _read_line, _LINES, _WORDS, (LineError, UsageError, HelpAsked))


def _read_line(data: bytes, _: Path) -> None:
    text = text_of(data)
    assert 0 <= word_start(text, len(text)) <= len(text)
    words = split(text)
    # The complaint about a word that is no verb takes a hundred times as long as all else.
    if verb_parser(words) is not None or len(data) % 16 == 0:
        parse(words)


def completion() -> Target:
    """Lines of the prompt that are to be completed, among some nodes."""
    return Target("completion", _complete, _LINES, _WORDS)


def _complete(data: bytes, _: Path) -> None:
    text = text_of(data)
    for cursor in (len(text), len(text) // 2):
        word_start(text, cursor)
        for each in complete(ModelGround(_some_nodes()), Packages(), text, cursor):
            assert each.strip()


@cache
def _some_nodes() -> Host:
    clock = PacedClock()
    host = Host(clock=clock, probe=SilentProbe(clock))
    context = Context(host=host)
    context.init([])
    node = Node("turtle", context=context, enable_rosout=False)
    node.declare_parameter("speed", 1.0)
    node.create_publisher(message("geometry_msgs", "Twist"), "/cmd_vel", 10)
    return host


def arguments() -> Target:
    """Command lines of nodes and launch files, one argument a line."""
    samples = (
        b"--ros-args\n-r\na:=/b\n-p\nspeed:=2.5\n--params-file\nx.yaml\n--log-level\nturtle:=debug\n--\n-v",
        b"--ros-args\n-r\n__node:=n\n-r\n__ns:=/x\n-p\nn:deep.name:=[1, 2]\n--disable-rosout-logs",
        b"a:=b\nname:=value with blanks",
        b"--ros-args\n--enclave\n/x\n-r\nrostopic://~/a:=b",
    )
    words = (
        b"--ros-args\n",
        b"\n-p\n",
        b"\n-r\n",
        b":=",
        b"__ns",
        b"*",
        b"\n--log-level\n",
        b"\n--params-file\n",
    )
    refusals = (ArgumentsError, LaunchError, NotImplementedError)
    return Target("arguments", _read_arguments, samples, words, refusals)


def _read_arguments(data: bytes, _: Path) -> None:
    words = text_of(data).split("\n")
    with suppress(LaunchError):
        read_arguments(words)
    with redirect_stderr(StringIO()):  # old forms are warned of
        parse_arguments(words)


def log() -> Target:
    """Log lines as they are drawn, formatted and filtered."""
    samples = (
        b"[INFO] [1.0] [turtle]: Odom CallBack",
        "\x1b[31mred\x1b[0m \u202egnp.exe\u202c \t界 e\u0301 \U0001f468\u200d\U0001f469".encode(),
        b'level:warn callback:odom "two words" thread:0_1 group:a',
        b"{severity} {time} {nothing} {message}",
    )
    words = (
        b"level:",
        b"group:",
        b"{name}",
        b"\\x1b",
        b"\x9b",
        b"[red]",
        b"[/]",
        b"\xe2\x80\x8d",
        b"\xcc\x81",
        b'"',
    )
    return Target("log", _show_line, samples, words, (FilterError,))


_PLACE = CallSite("f", "node.py", 3, 0)


def _show_line(data: bytes, _: Path) -> None:
    text = text_of(data)
    for charset in Charset:
        assert all(each.isprintable() for each in visible(without_tabs(text), charset))
        fit(text, 20, charset)
    shown = line_of(Logged(1, Severity.INFO, text, text, 0, 0))
    assert shown.isprintable()
    record = LogRecord(LoggingSeverity.WARN, text, text, 1_000, _PLACE)
    LogConsole({"RCUTILS_CONSOLE_OUTPUT_FORMAT": text}).line(record)
    filter_of(text)
