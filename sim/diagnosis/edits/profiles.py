"""Edits of the quality of service that a subscription requests or a publisher offers."""

import ast

from sim.diagnosis.edits.program_file import asked_of_file
from sim.diagnosis.edits.source_editor import NotSimpleError, SourceEditor, indentation

_KINDS = {
    "RELIABILITY": ("reliability", "ReliabilityPolicy", {"create_subscription": "BEST_EFFORT"}, "RELIABLE"),
    "DURABILITY": ("durability", "DurabilityPolicy", {"create_subscription": "VOLATILE"}, "TRANSIENT_LOCAL"),
}
_PLACES = {"create_subscription": 3, "create_publisher": 2}


@asked_of_file
def unmatched_beside(source: SourceEditor, policy: str, line: int, other: int) -> tuple[str, ...]:
    """Return which other policies of the endpoints at two lines differ, as far as their profiles tell."""
    return tuple(each for each in _KINDS if each != policy and _fails(source, each, line, other))


def match_quality(source: SourceEditor, line: int, policy: str, other: int = 0) -> None:
    """Let the endpoint at a line request no more than is offered, or offer what is requested.

    The profile is a number, or a ``QoSProfile(…)`` that nothing else uses; another one by name, as an
    imported one, is copied. The other end, at the line ``other`` (0: not in this source), may show that a
    second policy does not match either. It has the type that an end takes over, where the types differ.
    """
    if policy == "TYPE" and other:
        mine, theirs = (_endpoint(source, each)[0].args for each in (line, other))
        for old, new in zip(mine[:1], theirs[:1], strict=True):
            source.replace(old, source.code_of(new))
        return
    if policy not in _KINDS:
        raise NotSimpleError
    call, end = _endpoint(source, line)
    profile = _profile_of(call, end)
    policies = [policy, *(each for each in _KINDS if each != policy and _fails(source, each, line, other))]
    for each in policies:
        _set_policy(source, line, each, profile, end)


def set_depth(source: SourceEditor, line: int, depth: int) -> None:
    """Give the subscription at a line a queue of so many messages; one keeps the newest."""
    profile = _profile_of(*_endpoint(source, line))
    made = _made(source, profile)
    if made is None and isinstance(profile, ast.Constant):
        source.replace(profile, str(depth))
        return
    depths = [] if made is None else [each.value for each in made.keywords if each.arg == "depth"]
    if len(depths) != 1:
        raise NotSimpleError
    source.replace(depths[0], str(depth))


@asked_of_file
def published_at(source: SourceEditor, topic: str) -> int:
    """Return the line of the only call that creates a publisher of a topic by a string; 0 for none."""
    names = (topic, topic.rpartition("/")[2], topic[1:])
    lines = [
        call.lineno
        for call in source.nodes(ast.Call)
        if isinstance(call.func, ast.Attribute)
        and call.func.attr == "create_publisher"
        and any(isinstance(each, ast.Constant) and each.value in names for each in call.args)
    ]
    return lines[0] if len(lines) == 1 else 0


def keep_for_late(source: SourceEditor, line: int, publisher: int) -> None:
    """Let the endpoints at two lines be transient-local, so that the publisher keeps its last messages."""
    for each in (line, publisher):
        call, end = _endpoint(source, each)
        _set_policy(source, each, "DURABILITY", _profile_of(call, end), end, most=True)


def _set_policy(
    source: SourceEditor, line: int, policy: str, profile: ast.expr, end: str, *, most: bool = False
) -> None:
    """Let an end request the least there is, or offer the most; with ``most`` each end gets the latter."""
    keyword, kind, requested, offered = _KINDS[policy]
    value = f"{kind}.{offered if most else requested.get(end, offered)}"
    made = _made(source, profile)
    if made is None:
        statement = source.statement_at(line)
        name = "requested" if end in requested else "offered"
        name = next(each for each in (name, f"{name}_profile") if each not in source.text)
        code, blanks = source.code_of(profile), indentation(statement)
        if _is_depth(source, profile):
            begin = f"{name} = QoSProfile(depth={code}, {keyword}={value})\n{blanks}"
            source.import_names("rclpy.qos", ["QoSProfile", kind])
        else:
            begin = f"{name} = copy({code})\n{blanks}{name}.{keyword} = {value}\n{blanks}"
            source.import_names("copy", ["copy"])
            source.import_names("rclpy.qos", [kind])
        source.insert_before(statement, begin)
        source.replace(profile, name)
        return
    chosen = next((each for each in made.keywords if each.arg == keyword), None)
    if chosen is not None:
        source.replace(chosen.value, value)
    else:
        arguments = [*made.args, *(each.value for each in made.keywords)]
        if not arguments:
            raise NotSimpleError
        source.insert_behind(
            max(arguments, key=lambda each: (each.lineno, each.col_offset)), f", {keyword}={value}"
        )
    source.import_names("rclpy.qos", [kind])


def _fails(source: SourceEditor, policy: str, *lines: int) -> bool:
    """Return whether a policy of the endpoints at two lines does not match, as far as their profiles tell."""
    keyword, _, requested, offered = _KINDS[policy]
    values = {}
    for line in lines:
        try:
            call, end = _endpoint(source, line)
            made = _made(source, _profile_of(call, end))
        except NotSimpleError:
            return False
        if made is None:
            return False
        chosen = [ast.unparse(each.value) for each in made.keywords if each.arg == keyword]
        values[end] = chosen[0].rpartition(".")[2] if chosen else ""
    weak = requested["create_subscription"]
    return values.get("create_subscription") == offered and values.get("create_publisher") == weak


def _endpoint(source: SourceEditor, line: int) -> tuple[ast.Call, str]:
    """Return the call that creates the publisher or subscription at a line, and its function's name."""
    made = source.call_at(line, _PLACES.__contains__)
    return made, ast.unparse(made.func).rpartition(".")[2]


def _profile_of(call: ast.Call, end: str) -> ast.expr:
    named = [each.value for each in call.keywords if each.arg == "qos_profile"]
    placed = call.args[_PLACES[end] :][:1]
    if len(named) + len(placed) != 1:
        raise NotSimpleError
    return (named + placed)[0]


def _made(source: SourceEditor, profile: ast.expr) -> ast.Call | None:
    """Return the ``QoSProfile(…)`` that a profile is, or that is assigned to it if nothing else uses it."""
    code = source.code_of(profile)
    uses = sum(ast.unparse(each) == code for each in source.nodes(ast.expr))
    values = [profile] if isinstance(profile, ast.Call) else _assigned(source, profile)
    match values:
        case [ast.Call(func=ast.Name(id=name) | ast.Attribute(attr=name)) as made] if name == "QoSProfile":
            return made if made is profile or uses == 2 else None
    return None


def _assigned(source: SourceEditor, name: ast.expr) -> list[ast.expr]:
    """Return what is assigned to a name."""
    code = source.code_of(name)
    return [
        each.value
        for each in source.nodes(ast.Assign)
        if len(each.targets) == 1 and ast.unparse(each.targets[0]) == code
    ]


def _is_depth(source: SourceEditor, profile: ast.expr) -> bool:
    """Return whether a profile is a number, itself or by a name."""
    values = [profile] if isinstance(profile, ast.Constant) else _assigned(source, profile)
    return bool(values) and all(isinstance(each, ast.Constant) for each in values)
