"""The participants of a run: programs, threads, executors, nodes, callback groups and entities."""

from dataclasses import replace

import msgspec

from sim.trace.events import (
    EntityAppeared,
    EntityId,
    EntityKind,
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
from sim.trace.model import EntityInfo, ExecutorInfo, GroupInfo, Nanoseconds, ThreadInfo

_RATES = ("/ros/entities/timer.py", "/rclpy/timer.py")
"""The files of rates, of the model and of rclpy: a timer with a callback there is a rate's."""


class Participants:
    """The participants of a run by kind, in order of appearance, from the ``…Appeared`` events."""

    def __init__(self) -> None:
        self.processes: dict[ProcessId, str] = {}
        self.ended: dict[ProcessId, Nanoseconds] = {}
        """The end times of programs, in a run of several."""
        self.threads: dict[ThreadId, ThreadInfo] = {}
        self.executors: dict[ExecutorId, ExecutorInfo] = {}
        self.nodes: dict[NodeId, str] = {}
        self.ran_on: dict[NodeId, ThreadId] = {}
        self.groups: dict[GroupId, GroupInfo] = {}
        self.entities: dict[EntityId, EntityInfo] = {}
        self._members: dict[GroupId, list[EntityInfo]] = {}
        self._on_simulated_time: set[NodeId] = set()

    def members(self, group: GroupId) -> tuple[EntityInfo, ...]:
        """The entities of a group, empty for an unknown one."""
        return tuple(self._members.get(group, ()))

    def add_process(self, event: ProcessAppeared) -> None:
        """Add one of several programs."""
        self.processes[event.process] = event.label

    def end_process(self, event: ProcessEnded) -> None:
        """Note when one of several programs ended."""
        self.ended[event.process] = event.t

    def add_thread(self, event: ThreadAppeared) -> None:
        """Add a thread; among several programs its name is prefixed with its program's label."""
        label = self.processes.get(event.process)
        name = event.name if label is None else f"{label} {event.name}"
        self.threads[event.thread] = ThreadInfo(event.thread, name, event.t, event.process, event.executor)

    def add_executor(self, event: ExecutorAppeared, *, is_nested: bool) -> None:
        """Add an executor."""
        self.executors[event.executor] = ExecutorInfo(event.executor, event.kind, event.threads, is_nested)

    def add_node(self, event: NodeAppeared) -> None:
        """Add a node."""
        self.nodes[event.node] = event.name

    def note_call(self, entity: EntityId, thread: ThreadId) -> None:
        """Note that a callback of its node runs on a thread."""
        if entity in self.entities:
            self.ran_on[self.entities[entity].node] = thread

    def add_group(self, event: GroupAppeared) -> None:
        """Add a callback group with the next letter."""
        place = len(self.groups)
        self.groups[event.group] = GroupInfo(
            event.group, event.node, event.kind, event.class_name, place, event.is_own
        )

    def add_entity(self, event: EntityAppeared) -> EntityInfo:
        """Add an entity."""
        entity = EntityInfo(*msgspec.structs.astuple(event)[1:])
        if entity.kind is EntityKind.TIMER and entity.file.endswith(_RATES):
            entity = replace(entity, callback="rate's timer")  # rclpy has no name for it
        if entity.name == "/clock":
            self._on_simulated_time.add(entity.node)
        if entity.period > 0 and entity.node not in self._on_simulated_time:
            entity = replace(entity, first_due=event.t + entity.period)
        self.entities[event.entity] = entity
        self._members.setdefault(event.group, []).append(entity)
        return entity
