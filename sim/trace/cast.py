"""The cast of a run: its threads, executors, nodes, callback groups with their letters, and entities."""

from sim.trace.events import (
    EntityAppeared,
    EntityId,
    ExecutorAppeared,
    ExecutorId,
    GroupAppeared,
    GroupId,
    NodeAppeared,
    NodeId,
    ProcessAppeared,
    ProcessEnded,
    ProcessId,
    ThreadAppeared,
    ThreadId,
)
from sim.trace.model import Entity, Executor, Group, Nanoseconds, Thread


def letter(place: int) -> str:
    """The letter of the group that appeared as number ``place`` from 0: A, B, … Z, A2, B2, …"""
    turn, within = divmod(place, 26)
    return chr(ord("A") + within) + (str(turn + 1) if turn else "")


class Cast:
    """Who takes part, each kind in order of appearance; grows by the ``…Appeared`` events."""

    def __init__(self) -> None:
        self.processes: dict[ProcessId, str] = {}
        self.ended: dict[ProcessId, Nanoseconds] = {}
        """When those of several programs ended that have."""
        self.threads: dict[ThreadId, Thread] = {}
        self.executors: dict[ExecutorId, Executor] = {}
        self.nodes: dict[NodeId, str] = {}
        self.groups: dict[GroupId, Group] = {}
        self.entities: dict[EntityId, Entity] = {}
        self._members: dict[GroupId, list[Entity]] = {}

    def members(self, group: GroupId) -> tuple[Entity, ...]:
        """The entities of a group; none for one that is not known."""
        return tuple(self._members.get(group, ()))

    def add_process(self, event: ProcessAppeared) -> None:
        """Take in one of several programs."""
        self.processes[event.process] = event.label

    def end_process(self, event: ProcessEnded) -> None:
        """One of several programs is over."""
        self.ended[event.process] = event.t

    def add_thread(self, event: ThreadAppeared) -> None:
        """Take in a thread; among several programs its name begins with its program's label."""
        label = self.processes.get(event.process)
        name = event.name if label is None else f"{label} {event.name}"
        self.threads[event.thread] = Thread(event.thread, name, event.t, event.process, event.executor)

    def add_executor(self, event: ExecutorAppeared) -> None:
        """Take in an executor."""
        self.executors[event.executor] = Executor(event.executor, event.kind, event.threads)

    def add_node(self, event: NodeAppeared) -> None:
        """Take in a node."""
        self.nodes[event.node] = event.name

    def add_group(self, event: GroupAppeared) -> None:
        """Take in a group and give it the next letter."""
        name = letter(len(self.groups))
        self.groups[event.group] = Group(event.group, event.node, event.kind, event.class_name, name)

    def add_entity(self, event: EntityAppeared) -> Entity:
        """Take in an entity."""
        entity = Entity(
            event.entity,
            event.node,
            event.group,
            event.kind,
            event.name,
            event.callback,
            event.file,
            event.first_line,
            event.last_line,
            event.depth,
            event.period,
        )
        self.entities[event.entity] = entity
        self._members.setdefault(event.group, []).append(entity)
        return entity
