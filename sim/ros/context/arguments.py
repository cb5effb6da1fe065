"""ROS arguments: the arguments between ``--ros-args`` and ``--`` on a program's command line.

Source of the grammar: the ROS 2 design article "ROS command line arguments", and rcl.
"""

import re
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, field

from sim.ros.exceptions import RCLError, RCLInvalidROSArgsError, UnknownROSArgsError
from sim.ros.logging.logger import LoggingSeverity, get_logger, send_to, set_logger_level
from sim.ros.naming.remapping import RemapRule, RemapRuleError, is_rule, parse_rule
from sim.ros.parameters.yaml_files import (
    NodeParameters,
    ParameterYamlError,
    PlainValue,
    read_file,
    read_value,
)

_BEGIN = "--ros-args"
_END = "--"
_SWITCHES = {
    f"--{deed}-{what}-logs": (what, deed == "enable")
    for deed in ("enable", "disable")
    for what in ("rosout", "stdout", "external-lib")
}
"""The switches of logging. The one for ``external-lib`` has no effect: no log file is written here."""
_UNSUPPORTED = frozenset(("--log-config-file", "--log-file-name"))
_PARAMETER = re.compile(r"(?:([\w~/*]+):)?([\w.~/-]+):=(.*)", re.DOTALL)
_LEVELS = {level.name: level for level in LoggingSeverity}
_EVERY_NODE = "/**"


class ArgumentsError(ValueError):
    """A ROS argument cannot be read; the message says which and why."""


@dataclass(slots=True)
class Arguments:
    """The ROS arguments of a command line."""

    remap_rules: list[RemapRule] = field(default_factory=list)
    parameters: NodeParameters = field(default_factory=dict)
    parameter_sources: dict[str, list[str]] = field(default_factory=dict)
    """The full names of nodes, or patterns of them, by the file or argument that has values for them."""
    log_levels: dict[str, LoggingSeverity] = field(default_factory=dict)
    """Levels by logger; the empty name is the default level."""
    log_outputs: dict[str, bool] = field(default_factory=dict)
    """Whether log lines go to ``rosout`` and ``stdout``, where the arguments say so."""
    unknown: list[str] = field(default_factory=list)

    def require_all_known(self) -> None:
        """Raise UnknownROSArgsError if there is an unknown ROS argument."""
        if self.unknown:
            raise UnknownROSArgsError(f"Found unknown ROS arguments: {self.unknown}")

    def configure_logging(self) -> None:
        """Set the loggers' levels, and where their lines go."""
        send_to(console=self.log_outputs.get("stdout"), rosout=self.log_outputs.get("rosout"))
        for name, level in self.log_levels.items():
            set_logger_level(name, level)


def parse_arguments(args: Sequence[str]) -> Arguments:
    """Parse a command line; other arguments than ROS arguments are ignored.

    Raises:
        ArgumentsError: a ROS argument cannot be read.
        NotImplementedError: a ROS argument is not supported here.
    """
    found = Arguments()
    waiting = iter(args)
    inside = False
    for argument in waiting:
        if argument == _BEGIN:
            inside = True
        elif not inside:
            _read_plain(argument, found)
        elif argument == _END:
            inside = False
        else:
            _read_ros(argument, waiting, found)
    return found


def arguments_of_program(args: Sequence[str]) -> Arguments:
    """Parse the arguments of ``rclpy.init``.

    Raises:
        RCLError, UnknownROSArgsError: a ROS argument cannot be read, or is unknown.
        UnicodeEncodeError: an argument is not UTF-8.
    """
    for each in args:
        each.encode()
    try:
        found = parse_arguments(args)
    except ArgumentsError as error:
        raise RCLError(f"failed to initialize rcl: {error}") from None
    found.require_all_known()
    return found


def arguments_of_node(args: Sequence[str]) -> Arguments:
    """Parse a node's ``cli_args``.

    Raises:
        RCLInvalidROSArgsError, UnknownROSArgsError: a ROS argument cannot be read, or is unknown.
    """
    try:
        found = parse_arguments(args)
    except ArgumentsError as error:
        raise RCLInvalidROSArgsError(f"Failed to parse ROS arguments: {error}") from None
    found.require_all_known()
    return found


def parameters_for(full_name: str, sources: Iterable[Arguments]) -> dict[str, PlainValue]:
    """The values of a node's parameters on command lines; later sources override earlier ones.

    Entries for several nodes (``/**``, ``/*/name``) apply in their order; the node's own override them.
    """
    by_node: NodeParameters = {}
    for source in sources:
        for name, values in source.parameters.items():
            by_node.setdefault(_full(name), {}).update(values)
    own = by_node.pop(full_name, {})
    chosen: dict[str, PlainValue] = {}
    for pattern, values in by_node.items():
        if _matches(pattern, full_name):
            chosen.update(values)
    return chosen | own


def is_for_any(patterns: Iterable[str], full_names: Collection[str]) -> bool:
    """Whether one of the full names of nodes, or patterns of them, is for one of the nodes."""
    return any(pattern == name or _matches(pattern, name) for pattern in patterns for name in full_names)


def _full(name: str) -> str:
    """A node's name, or a pattern of such, with its first slash, which may be left out."""
    return f"/{name.lstrip('/')}"


def _matches(pattern: str, full_name: str) -> bool:
    if "*" not in pattern:
        return False
    form = re.escape(pattern).replace(r"/\*\*", r"(/\w+)*").replace(r"/\*", r"/\w+")
    return re.fullmatch(form, full_name) is not None


def _read_plain(argument: str, found: Arguments) -> None:
    """Read a remapping rule in the old form, outside of ``--ros-args``."""
    if not is_rule(argument):
        return
    found.remap_rules.append(parse_rule(argument))
    get_logger("rcl").warning(
        f"Found remap rule '{argument}'. This syntax is deprecated. "
        f"Use '--ros-args --remap {argument}' instead."
    )


def _read_ros(argument: str, waiting: Iterator[str], found: Arguments) -> None:
    if argument in _UNSUPPORTED:
        raise NotImplementedError(f"the ROS argument {argument} is not supported")
    if argument in _SWITCHES:
        what, wanted = _SWITCHES[argument]
        found.log_outputs[what] = wanted
        return
    flag = _FLAGS.get(argument)
    if flag is None:
        found.unknown.append(argument)
        return
    value = next(waiting, None)
    if value is None:
        raise ArgumentsError(flag.nothing_follows.format(argument))
    try:
        flag.read(value, found)
    except (RemapRuleError, ParameterYamlError, ArgumentsError) as error:
        raise ArgumentsError(f"Couldn't parse {flag.what}: '{argument} {value}'. Error: {error}") from None


def _read_remap(value: str, found: Arguments) -> None:
    found.remap_rules.append(parse_rule(value))


def _read_parameter(value: str, found: Arguments) -> None:
    form = _PARAMETER.fullmatch(value)
    if form is None:
        raise ArgumentsError("a parameter is written as name:=value or node:name:=value")
    node, name, text = form.groups()
    found.parameters.setdefault(node or _EVERY_NODE, {})[name] = read_value(text)
    found.parameter_sources[f"-p {value}"] = [_full(node or _EVERY_NODE)]


def _read_parameter_file(value: str, found: Arguments) -> None:
    read = read_file(value)
    for node, values in read.items():
        found.parameters.setdefault(node, {}).update(values)
    found.parameter_sources[value] = list(map(_full, read))


def _read_log_level(value: str, found: Arguments) -> None:
    logger, sign, name = value.rpartition(":=")
    if sign and not logger:
        raise ArgumentsError("a logger's level is written as logger:=level")
    level = _LEVELS.get(name.upper())
    if level is None:
        raise ArgumentsError(f"a level is one of {', '.join(_LEVELS).lower()}, not {name!r}")
    found.log_levels[logger] = level


def _read_enclave(_value: str, _found: Arguments) -> None:
    """Ignore the name of a security enclave: the model has no security."""


@dataclass(frozen=True, slots=True)
class _Flag:
    what: str
    nothing_follows: str
    read: Callable[[str, Arguments], None]


_PARAM = _Flag(
    "parameter override rule",
    "Couldn't parse trailing {} flag. No parameter override rule found.",
    _read_parameter,
)
_REMAP = _Flag("remap rule", "Couldn't parse trailing {} flag. No remap rule found.", _read_remap)
_ENCLAVE = _Flag("enclave name", "Couldn't parse trailing {} flag. No enclave path provided.", _read_enclave)
_FLAGS = {
    "-p": _PARAM,
    "--param": _PARAM,
    "-r": _REMAP,
    "--remap": _REMAP,
    "--params-file": _Flag(
        "params file", "Couldn't parse trailing {} flag. No file path provided.", _read_parameter_file
    ),
    "--log-level": _Flag(
        "log level", "Couldn't parse trailing log level flag: '{}'. No log level found.", _read_log_level
    ),
    "-e": _ENCLAVE,
    "--enclave": _ENCLAVE,
}
