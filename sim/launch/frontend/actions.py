"""Turns the elements of a launch file in XML or YAML into launch's actions."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import yaml

from sim.launch.errors import LaunchFailure, explained
from sim.launch.frontend.elements import LaunchElement, read_elements
from sim.launch.frontend.texts import substitutions
from sim.launch.launch import actions as launch
from sim.launch.launch.action import Action
from sim.launch.launch.conditions import IfCondition, UnlessCondition
from sim.launch.launch.launch_description_sources import AnyLaunchDescriptionSource
from sim.launch.launch.substitution import TextSubstitution
from sim.launch.launch_ros import actions as ros
from sim.launch.launch_ros.parameter_descriptions import ParameterValue

_TYPES = {"bool": bool, "float": float, "int": int, "str": str}


def actions_in(file: Path, source: bytes) -> list[Action]:
    """Return the actions of a launch file in XML or YAML, each with its line.

    Raises:
        LaunchError: the file cannot be read, or an element is wrong; the text names the line.
    """
    return list(_inside(read_elements(file, source), file))


def _inside(element: LaunchElement, file: Path) -> Iterator[Action]:
    for each in element.inside:
        try:
            action = _action(each, file)
        except Exception as error:
            raise explained(error, file, (str(file), each.line)) from error
        action.place = (str(file), each.line)
        yield action


def _action(element: LaunchElement, file: Path) -> Action:
    make = _ACTIONS.get(element.tag.replace("-", "_"))
    if make is None:
        raise LaunchFailure(f"there is no action <{element.tag}>; there are {', '.join(sorted(_ACTIONS))}")
    made = make(element, _condition(element), file)
    unknown = sorted(element.attributes.keys() - element.taken)
    if unknown:
        raise LaunchFailure(f"<{element.tag}> has no attribute {unknown[0]!r}")
    return made


def _condition(element: LaunchElement) -> dict[str, Any]:
    holds, fails = element.get("if"), element.get("unless")
    if holds is not None and fails is not None:
        raise LaunchFailure(f"<{element.tag}> has both 'if' and 'unless'")
    if holds is not None:
        return {"condition": IfCondition(substitutions(holds))}
    return {} if fails is None else {"condition": UnlessCondition(substitutions(fails))}


def _text(element: LaunchElement, *names: str) -> Any:
    found = element.get(*names)
    return None if found is None else substitutions(found)


def _given(**arguments: Any) -> dict[str, Any]:
    """Return the arguments that are not None."""
    return {name: value for name, value in arguments.items() if value is not None}


def _arg(element: LaunchElement, condition: dict[str, Any], _file: Path) -> Action:
    given = _given(default_value=_text(element, "default"), description=element.get("description"))
    choices = [each.need("value") for each in element.all("choice")]
    return launch.DeclareLaunchArgument(element.need("name"), choices=choices or None, **given, **condition)


def _name_and_value(element: LaunchElement) -> tuple[Any, Any]:
    return substitutions(element.need("name")), substitutions(element.need("value"))


def _remapping(element: LaunchElement) -> tuple[Any, Any]:
    return substitutions(element.need("from")), substitutions(element.need("to"))


def _node(element: LaunchElement, condition: dict[str, Any], _file: Path) -> Action:
    parameters: list[Any] = []
    for each in element.all("param"):
        source = _text(each, "from")
        parameters.append(_parameter(each) if source is None else source)
    remappings = [_remapping(each) for each in element.all("remap")]
    return ros.Node(
        package=substitutions(element.need("pkg")),
        executable=substitutions(element.need("exec")),
        parameters=parameters or None,
        remappings=remappings or None,
        **_given(
            name=_text(element, "name"),
            namespace=_text(element, "namespace", "ns"),
            exec_name=_text(element, "exec_name"),
            arguments=_words(element.get("args")),
            ros_arguments=_words(element.get("ros_args")),
        ),
        **_process(element),
        **condition,
    )


def _executable(element: LaunchElement, condition: dict[str, Any], _file: Path) -> Action:
    named = _given(name=_text(element, "name"))
    return launch.ExecuteProcess(
        cmd=_words(element.need("cmd")) or [], **named, **_process(element), **condition
    )


def _process(element: LaunchElement) -> dict[str, Any]:
    """Return the arguments that nodes and other processes have in common."""
    environment = {name[0].text: value for name, value in map(_name_and_value, element.all("env"))}
    delay = element.get("respawn_delay")
    for without_effect in ("emulate_tty", "launch-prefix", "sigterm_timeout", "sigkill_timeout"):
        element.get(without_effect)
    return _given(
        output=_text(element, "output"),
        cwd=_text(element, "cwd"),
        respawn=_text(element, "respawn"),
        respawn_delay=None if delay is None else float(delay),
        additional_env=environment or None,
    )


def _words(text: str | None) -> list[Any] | None:
    """Return the words of a command line, each with its substitutions; None for no line."""
    if text is None:
        return None
    lexer = shlex.shlex(text, posix=True, punctuation_chars=False)
    lexer.whitespace_split, lexer.commenters = True, ""
    words: list[str] = []
    for word in lexer:
        # A substitution may have spaces in it.
        is_inside = bool(words) and words[-1].count("$(") > words[-1].count(")")
        words[-1:] = [f"{words[-1]} {word}"] if is_inside else [*words[-1:], word]
    return [substitutions(word) for word in words]


def _parameter(element: LaunchElement) -> dict[str, Any]:
    """Return a parameter, or nested parameters, by name."""
    name = element.need("name")
    inside = element.all("param")
    if inside:
        return {name: {key: value for each in inside for key, value in _parameter(each).items()}}
    return {name: _value(element)}


def _value(element: LaunchElement) -> Any:
    """Return a parameter's value, of the given type, or of the type that YAML sees in its text."""
    parts = substitutions(element.need("value"))
    wanted = _TYPES.get(element.get("type") or "")
    texts = [each.text for each in parts if isinstance(each, TextSubstitution)]
    if wanted is not None:
        return ParameterValue(parts, value_type=wanted)
    return yaml.safe_load("".join(texts)) if len(texts) == len(parts) else parts


def _include(element: LaunchElement, condition: dict[str, Any], _file: Path) -> Action:
    given = [_name_and_value(each) for each in element.all("arg", "let")]
    source = AnyLaunchDescriptionSource(substitutions(element.need("file")))
    return launch.IncludeLaunchDescription(source, launch_arguments=given or None, **condition)


def _group(element: LaunchElement, condition: dict[str, Any], file: Path) -> Action:
    scoped = yaml.safe_load(element.get("scoped") or "true")
    return launch.GroupAction(list(_inside(element, file)), scoped=scoped, **condition)


def _timer(element: LaunchElement, condition: dict[str, Any], file: Path) -> Action:
    period = float(element.need("period"))
    return launch.TimerAction(period=period, actions=list(_inside(element, file)), **condition)


def _log(element: LaunchElement, condition: dict[str, Any], _file: Path) -> Action:
    element.get("level")
    return launch.LogInfo(msg=substitutions(element.need("message")), **condition)


def _shutdown(element: LaunchElement, condition: dict[str, Any], _file: Path) -> Action:
    return launch.Shutdown(**_given(reason=element.get("reason")), **condition)


def _namespace(element: LaunchElement, condition: dict[str, Any], _file: Path) -> Action:
    return ros.PushROSNamespace(substitutions(element.need("namespace", "ns")), **condition)


def _set_parameter(element: LaunchElement, condition: dict[str, Any], _file: Path) -> Action:
    return ros.SetParameter(substitutions(element.need("name")), _value(element), **condition)


def _container(_element: LaunchElement, _condition: dict[str, Any], _file: Path) -> Action:
    ros.ComposableNodeContainer()
    raise AssertionError


_ACTIONS: Mapping[str, Callable[[LaunchElement, dict[str, Any], Path], Action]] = {
    "arg": _arg,
    "executable": _executable,
    "group": _group,
    "include": _include,
    "let": lambda each, condition, _: launch.SetLaunchConfiguration(*_name_and_value(each), **condition),
    "load_composable_node": _container,
    "log": _log,
    "node": _node,
    "node_container": _container,
    "push_ros_namespace": _namespace,
    "set_env": lambda each, condition, _: launch.SetEnvironmentVariable(*_name_and_value(each), **condition),
    "set_parameter": _set_parameter,
    "set_remap": lambda each, condition, _: ros.SetRemap(*_remapping(each), **condition),
    "shutdown": _shutdown,
    "timer": _timer,
}
