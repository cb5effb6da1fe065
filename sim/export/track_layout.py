"""The tracks of a run: processes with their threads, groups with their callbacks, robot, services, log."""

from dataclasses import dataclass

from sim.export.texts import printable
from sim.export.trace_sink import TraceSink, Track, TrackId, TrackKind
from sim.trace.events import EntityId, EntityKind, GroupId, NodeId, ProcessId, ThreadAppeared, ThreadId
from sim.trace.model import EntityInfo, Nanoseconds
from sim.trace.participants import Participants

GROUPS = "callback groups"
ROBOT = "robot"
SERVICES = "services"
NODES = "nodes outside callbacks"


@dataclass(slots=True)
class EntityTracks:
    """An entity's name, args and tracks in the trace file; a track has id 0 until it is needed."""

    name: str
    group: GroupId
    kind: EntityKind | None
    depth: int
    args: dict[str, str | int | float]
    waits: TrackId = 0
    queue: TrackId = 0
    shown_depth: int = -1


@dataclass(slots=True)
class GroupTracks:
    """The tracks of one group, one for each simultaneous call; ``busy``: whether each has a call."""

    tracks: list[TrackId]
    busy: list[bool]


class TrackLayout:
    """Assigns ids to tracks, and adds a track to the sink when it is first needed."""

    def __init__(self, sink: TraceSink) -> None:
        self.participants = Participants()
        self._sink = sink
        self._made = 0
        self._title = "program"
        self._processes: dict[ProcessId, TrackId] = {}
        self._threads: dict[ThreadId, TrackId] = {}
        self._groups: dict[GroupId, GroupTracks] = {}
        self._entities: dict[EntityId, EntityTracks] = {}
        self._named: dict[tuple[str, str], TrackId] = {}
        self._counters: dict[str, tuple[TrackId, float]] = {}

    def begin(self, title: str) -> None:
        """Set the name of a single program's process."""
        self._title = printable(title) or self._title

    def add_thread(self, event: ThreadAppeared) -> None:
        """Add a thread below its process, with the name that rclpy gives it."""
        self.participants.add_thread(event)
        self._threads[event.thread] = self._add(TrackKind.THREAD, event.name, self._process(event.process))

    def thread(self, thread: ThreadId) -> TrackId:
        """The track of a thread; an unknown thread is named by its number."""
        track = self._threads.get(thread)
        if track is None:
            track = self._threads[thread] = self._add(TrackKind.THREAD, f"thread {thread}", self._process(0))
        return track

    def thread_name(self, thread: ThreadId) -> str:
        """The name of a thread; of several processes, with its process."""
        known = self.participants.threads.get(thread)
        return f"thread {thread}" if known is None else printable(known.name)

    def add_group(self, group: GroupId) -> None:
        """Add a group."""
        self._lanes(group)

    def enter(self, group: GroupId) -> int:
        """Take the first free lane of a group; a new one if all are busy."""
        lanes = self._lanes(group)
        if all(lanes.busy):
            lanes.tracks.append(self._add_lane(group))
            lanes.busy.append(False)
        lane = lanes.busy.index(False)
        lanes.busy[lane] = True
        return lane

    def lane(self, group: GroupId, lane: int) -> TrackId:
        """The track of a group's lane."""
        return self._groups[group].tracks[lane]

    def leave(self, group: GroupId, lane: int) -> None:
        """Release a lane of a group."""
        self._groups[group].busy[lane] = False

    def entity(self, entity: EntityId) -> EntityTracks:
        """An entity; an unknown one is named by its number."""
        known = self._entities.get(entity)
        if known is None:
            known = self._entities[entity] = self._make_entity(entity, self.participants.entities.get(entity))
        return known

    def waits(self, entity: EntityTracks) -> TrackId:
        """The track of an entity's waits."""
        if not entity.waits:
            topic = entity.args.get("topic")
            name = f"{entity.name} ({topic})" if topic and topic != entity.name else entity.name
            entity.waits = self._add(TrackKind.LANE, name, self._group_track(entity.group))
        return entity.waits

    def queue(self, entity: EntityTracks) -> TrackId:
        """The counter of an entity's queue."""
        if not entity.queue:
            name = f"queue of {entity.name}"
            entity.queue = self._add(TrackKind.COUNTER, name, self._group_track(entity.group), "messages")
        return entity.queue

    def service(self, name: str) -> TrackId:
        """The track of calls and replies outside callbacks."""
        return self._named_lane(SERVICES, name)

    def node(self, node: NodeId) -> TrackId:
        """The track of what a node publishes outside callbacks; 0 is the robot's driver."""
        if node == 0:
            return self._named_lane(ROBOT, "published by the robot")
        return self._named_lane(NODES, self.participants.nodes.get(node, f"node {node}"))

    def text_lane(self, name: str) -> TrackId:
        """The track of the log, the commands or the notices."""
        return self._named_lane("", name)

    def set_robot_counter(self, name: str, unit: str, t: Nanoseconds, value: float) -> None:
        """Write a value of one of the robot's counters, unless it has not changed."""
        track, shown = self._counters.get(name, (0, None))
        if value == shown:
            return
        if not track:
            track = self._add(TrackKind.COUNTER, name, self._folder(ROBOT), unit)
        self._counters[name] = (track, value)
        self._sink.count(track, t, value)

    def _make_entity(self, entity: EntityId, known: EntityInfo | None) -> EntityTracks:
        if known is None:
            return EntityTracks(f"callback {entity}", 0, None, 0, {"entity": f"entity {entity}"})
        args: dict[str, str | int | float] = {"entity": known.kind.value}
        if known.name:
            args["topic"] = printable(known.name)
        group = self.participants.groups.get(known.group)
        if group is not None:
            args["group"] = group.letter
        args["node"] = printable(self.participants.nodes.get(known.node, f"node {known.node}"))
        return EntityTracks(printable(known.spoken_name), known.group, known.kind, known.depth, args)

    def _process(self, process: ProcessId) -> TrackId:
        if process not in self._processes:
            name = self.participants.processes.get(process, self._title)
            self._processes[process] = self._add(TrackKind.PROCESS, name)
        return self._processes[process]

    def _lanes(self, group: GroupId) -> GroupTracks:
        if group not in self._groups:
            self._groups[group] = GroupTracks([self._add_lane(group)], [False])
        return self._groups[group]

    def _add_lane(self, group: GroupId) -> TrackId:
        return self._add(TrackKind.LANE, self._group_name(group), self._folder(GROUPS))

    def _group_track(self, group: GroupId) -> TrackId:
        return self._lanes(group).tracks[0]

    def _group_name(self, group: GroupId) -> str:
        known = self.participants.groups.get(group)
        if known is None:
            return "unknown group"
        node = self.participants.nodes.get(known.node, f"node {known.node}")
        return f"{known.letter} {known.kind.value} {node}"

    def _folder(self, name: str) -> TrackId:
        if (name, "") not in self._named:
            self._named[name, ""] = self._add(TrackKind.FOLDER, name)
        return self._named[name, ""]

    def _named_lane(self, folder: str, name: str) -> TrackId:
        if (folder, name) not in self._named:
            parent = self._folder(folder) if folder else 0
            self._named[folder, name] = self._add(TrackKind.LANE, name, parent)
        return self._named[folder, name]

    def _add(self, kind: TrackKind, name: str, parent: TrackId = 0, unit: str = "") -> TrackId:
        self._made += 1
        self._sink.add(Track(self._made, kind, printable(name), parent, unit))
        return self._made
