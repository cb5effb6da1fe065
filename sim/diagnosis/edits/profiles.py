"""Edits of the quality of service that a subscription requests or a publisher offers."""

import ast

from sim.diagnosis.edits.source_editor import NotSimpleError, SourceEditor, indentation

_KINDS = {
    "RELIABILITY": ("reliability", "ReliabilityPolicy", {"create_subscription": "BEST_EFFORT"}, "RELIABLE"),
    "DURABILITY": ("durability", "DurabilityPolicy", {"create_subscription": "VOLATILE"}, "TRANSIENT_LOCAL"),
}
_PLACES = {"create_subscription": 3, "create_publisher": 2}


def match_quality(source: SourceEditor, line: int, policy: str, other: int = 0) -> None:
    """Let the endpoint at a line request no more than is offered, or offer what is requested.

    Only for a profile that is a number, or a ``QoSProfile(…)`` that nothing else uses. The other end, at the
    line ``other`` (0: not in this source), may show that a second policy does not match either.
    """
    if policy not in _KINDS:
        raise NotSimpleError
    call, end = _endpoint(source, line)
    profile = _profile_of(call, end)
    policies = [policy, *(each for each in _KINDS if each != policy and _fails(source, each, line, other))]
    for each in policies:
        _set_policy(source, line, each, profile, end)


def _set_policy(source: SourceEditor, line: int, policy: str, profile: ast.expr, end: str) -> None:
    keyword, kind, requested, offered = _KINDS[policy]
    value = f"{kind}.{requested.get(end, offered)}"
    if isinstance(profile, ast.Constant) and isinstance(profile.value, int):
        statement = source.statement_at(line)
        name = "requested" if end in requested else "offered"
        name = next(each for each in (name, f"{name}_profile") if each not in source.text)
        assignment = f"{name} = QoSProfile(depth={profile.value}, {keyword}={value})"
        source.insert_before(statement, f"{assignment}\n{indentation(statement)}")
        source.replace(profile, name)
        source.import_names("rclpy.qos", ["QoSProfile", kind])
        return
    made = profile if isinstance(profile, ast.Call) else _assigned(source, profile)
    if not isinstance(made.func, ast.Name | ast.Attribute) or not ast.unparse(made.func).endswith(
        "QoSProfile"
    ):
        raise NotSimpleError
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
            profile = _profile_of(call, end)
            made = profile if isinstance(profile, ast.Call) else _assigned(source, profile)
        except NotSimpleError:
            return False
        chosen = [ast.unparse(each.value) for each in made.keywords if each.arg == keyword]
        values[end] = chosen[0].rpartition(".")[2] if chosen else ""
    weak = requested["create_subscription"]
    return values.get("create_subscription") == offered and values.get("create_publisher") == weak


def _endpoint(source: SourceEditor, line: int) -> tuple[ast.Call, str]:
    """Return the call that creates the publisher or subscription at a line, and its function's name."""
    found = [
        (each, each.func.attr)
        for each in source.nodes(ast.Call)
        if isinstance(each.func, ast.Attribute)
        and each.func.attr in _PLACES
        and each.lineno <= line <= (each.end_lineno or 0)
    ]
    if len(found) != 1:
        raise NotSimpleError
    return found[0]


def _profile_of(call: ast.Call, end: str) -> ast.expr:
    named = [each.value for each in call.keywords if each.arg == "qos_profile"]
    placed = call.args[_PLACES[end] :][:1]
    if len(named) + len(placed) != 1:
        raise NotSimpleError
    return (named + placed)[0]


def _assigned(source: SourceEditor, name: ast.expr) -> ast.Call:
    """Return the call that is assigned to a name, if the name is assigned once and used once."""
    code = source.code_of(name)
    same = [each for each in source.nodes(ast.expr) if ast.unparse(each) == code]
    values = [
        each.value
        for each in source.nodes(ast.Assign)
        if len(each.targets) == 1 and ast.unparse(each.targets[0]) == code
    ]
    if len(same) != 2 or len(values) != 1 or not isinstance(values[0], ast.Call):
        raise NotSimpleError
    return values[0]
