"""The program's functions that executors run as tasks on the trace: done-callbacks, goals' execute callbacks.

A task belongs to no callback group. So that the trace shows it, each such function has an entity, in a
group of its own that stands for none.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from types import CodeType
from typing import Any

from sim.probes.on_path.cbtui_probe.naming import code_of, owner_of
from sim.probes.own_code import is_written
from sim.ros.scheduling.callback_groups import ReentrantCallbackGroup
from sim.ros.scheduling.entity import Entity, OwnerNode, TakenData
from sim.ros.scheduling.task import Task
from sim.trace.events import EntityKind, GroupKind


class NoGroup(ReentrantCallbackGroup):
    """Stands on the trace for the group of what is in none."""

    trace_kind = GroupKind.NONE


class TaskEntity(Entity):
    """The entity that stands for a function of the program that an executor runs as a task.

    No node has it, and no executor yields it.
    """

    rank = -1

    def __init__(
        self, node: OwnerNode, kind: EntityKind, name: str, function: Callable[..., Any] | None
    ) -> None:
        self.kind = kind
        self.callback = function
        super().__init__(node, name, NoGroup())
        node.context.probe.entity_made(self)

    def take(self, now: int) -> TakenData | None:
        """None: nothing arrives here."""
        return None

    def invoke(self, taken: TakenData) -> None:
        """Do nothing: nothing can be taken."""

    def destroy(self) -> None:
        """Remove it from the trace. With the host's lock held."""
        self.destroyed = True
        self.node.context.probe.entity_gone(self)


def program_task(task: Task[Any], nodes: Callable[[], list[OwnerNode]]) -> TaskEntity | None:
    """Return the entity of a task's function; None if it is not the program's, or the executor has no node.

    It is in the node whose method it is, else in the first one of ``nodes``. With the host's lock held.
    """
    function = task._handler
    code = code_of(function)
    if code is None or not _is_written(code.co_filename):
        return None
    served, owner = nodes(), owner_of(function)
    if not served:
        return None
    node = next((each for each in served if each is owner), served[0])
    known: dict[CodeType, TaskEntity] = node._agenda.tasks
    if code not in known:
        known[code] = TaskEntity(node, EntityKind.TASK, "", function)
    return known[code]


_is_written = lru_cache(maxsize=256)(is_written)
