"""What the methods of a class share: whether one uses what another one changes, and what locks guard."""

import ast
from collections import defaultdict
from collections.abc import Iterator

from sim.diagnosis.edits.locks import keeps_lock
from sim.diagnosis.edits.program_file import asked_of_file
from sim.diagnosis.edits.source_editor import Function, NotSimpleError, SourceEditor

_SENDS = ("publish", "call_async", "call", "send_goal_async")
"""Methods of an attribute that leave it as it is."""


@asked_of_file
def uses_what_is_set(source: SourceEditor, setter: int, user: int) -> bool | None:
    """Return whether a method uses what another one of its class sets; None if the source does not tell.

    ``setter`` and ``user`` are lines of theirs. What methods of the class do that they call counts as theirs.
    """
    try:
        one, other = _Reach(source, setter), _Reach(source, user)
    except NotSimpleError:
        return None
    return one.owner is not other.owner or bool(one.changed & other.used.keys())


@asked_of_file
def guards_what_it_changes(source: SourceEditor, line: int) -> bool:
    """Return whether a method changes anything of its node's, and uses it inside ``with`` of a lock alone.

    ``line`` is one of its lines. What methods of the class do that it calls counts as its.
    """
    try:
        reach = _Reach(source, line)
    except NotSimpleError:
        return False
    lines = [each for name in reach.changed for each in reach.used[name]]
    return bool(lines) and all(keeps_lock(source, each) for each in lines)


class _Reach:
    """The attributes and global variables that the method around a line, and what it calls of its class, use.

    Raises:
        NotSimpleError: not known: it is no method of a plain node, hands ``self`` on, or sets globals.
    """

    def __init__(self, source: SourceEditor, line: int) -> None:
        self.used: defaultdict[str, list[int]] = defaultdict(list)
        """The lines of each."""
        self.changed: set[str] = set()
        first = source.function_at(line)
        owner = source.owner_of(first)
        if owner is None or [*map(ast.unparse, owner.bases)] not in (["Node"], ["rclpy.node.Node"]):
            raise NotSimpleError
        self.owner = owner
        targets = (target for each in source.tree.body for target in getattr(each, "targets", ()))
        self._globals = {each.id for target in targets for each in source.nodes(ast.Name, target)}
        methods = {each.name: each for each in owner.body if isinstance(each, Function)}
        known, left = {first.name}, [first]
        while left:
            method = left.pop()
            called = {*self._reached_in(method)} & methods.keys() - known
            known |= called
            left += (methods[each] for each in called)

    def _reached_in(self, method: Function) -> Iterator[str]:
        """Note what a method uses and changes itself; yield the methods of ``self`` that it names."""
        itself = method.args.args[0].arg if method.args.args else ""
        parents = {child: each for each in ast.walk(method) for child in ast.iter_child_nodes(each)}
        for each in ast.walk(method):
            if isinstance(each, ast.Global | ast.Nonlocal):
                raise NotSimpleError
            if isinstance(each, ast.Name) and each.id in self._globals:
                self.used[each.id].append(each.lineno)
                self.changed.add(each.id)
            if not (isinstance(each, ast.Name) and each.id == itself):
                continue
            attribute = parents[each]
            if not isinstance(attribute, ast.Attribute):
                raise NotSimpleError
            yield attribute.attr
            parent = parents[attribute]
            if isinstance(parent, ast.Call) and parent.func is attribute:
                continue
            self.used[attribute.attr].append(attribute.lineno)
            if _changes(attribute, parents):
                self.changed.add(attribute.attr)


def _changes(attribute: ast.expr, parents: dict[ast.AST, ast.AST]) -> bool:
    """Return whether an attribute, or a part of it, is set, or one of its methods may change it."""
    context = vars(attribute).get("ctx")
    parent = parents[attribute]
    if isinstance(context, ast.Store | ast.Del):
        return True
    if isinstance(parent, ast.Attribute | ast.Subscript) and parent.value is attribute:
        return _changes(parent, parents)
    is_method = isinstance(parent, ast.Call) and parent.func is attribute
    return is_method and isinstance(attribute, ast.Attribute) and attribute.attr not in _SENDS
