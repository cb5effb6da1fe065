"""The tracks of a run: processes with their threads, groups with their callbacks, robot, services, log."""

from dataclasses import dataclass, field

from sim.export.sink import Sink, Track, TrackId, TrackKind
from sim.export.texts import printable
from sim.trace.events import EntityId, EntityKind, GroupId, NodeId, ProcessId, ThreadAppeared, ThreadId
from sim.trace.model import Entity, Nanoseconds
from sim.trace.participants import Participants

GROUPS = "callback groups"
ROBOT = "robot"
SERVICES = "services"
NODES = "nodes outside callbacks"


@dataclass(slots=True)
class Actor:
    """An entity as the picture shows it."""

    name: str
    group: GroupId
    kind: EntityKind | None
    depth: int
    facts: dict[str, str | int | float]
    waits: TrackId = 0
    queue: TrackId = 0
    shown_depth: int = -1


@dataclass(slots=True)
class Lanes:
    """The tracks of one group, one for each call at once; ``busy`` tells which of them are taken."""

    tracks: list[TrackId] = field(default_factory=list)
    busy: list[bool] = field(default_factory=list)

    def enter(self) -> int:
        """Take the first free lane; the number of lanes if there is none."""
        for lane, taken in enumerate(self.busy):
            if not taken:
                self.busy[lane] = True
                return lane
        return len(self.busy)


class TrackLayout:
    """Gives the ids of tracks, and shows a track to the sink when it is first needed."""

    def __init__(self, sink: Sink) -> None:
        self.participants = Participants()
        self._sink = sink
        self._made = 0
        self._title = "program"
        self._processes: dict[ProcessId, TrackId] = {}
        self._threads: dict[ThreadId, TrackId] = {}
        self._groups: dict[GroupId, Lanes] = {}
        self._actors: dict[EntityId, Actor] = {}
        self._named: dict[tuple[str, str], TrackId] = {}
        self._counters: dict[str, tuple[TrackId, float]] = {}

    def begin(self, title: str) -> None:
        """Name the program that runs."""
        self._title = printable(title) or self._title

    def add_thread(self, event: ThreadAppeared) -> None:
        """A thread appears, under its process, with the name that rclpy gives it."""
        self.participants.add_thread(event)
        self._threads[event.thread] = self._add(TrackKind.THREAD, event.name, self._process(event.process))

    def thread(self, thread: ThreadId) -> TrackId:
        """The track of a thread; one that did not appear gets a name of its number."""
        track = self._threads.get(thread)
        if track is None:
            track = self._threads[thread] = self._add(TrackKind.THREAD, f"thread {thread}", self._process(0))
        return track

    def thread_name(self, thread: ThreadId) -> str:
        """What a thread is called, among several processes with its process."""
        known = self.participants.threads.get(thread)
        return f"thread {thread}" if known is None else printable(known.name)

    def add_group(self, group: GroupId) -> None:
        """A known group appears."""
        self._lanes(group)

    def enter(self, group: GroupId) -> int:
        """Take a lane of a group."""
        lanes = self._lanes(group)
        lane = lanes.enter()
        if lane == len(lanes.busy):
            lanes.busy.append(True)
            if lane == len(lanes.tracks):
                lanes.tracks.append(self._add(TrackKind.LANE, self._group_name(group), self._folder(GROUPS)))
        return lane

    def lane(self, group: GroupId, lane: int) -> TrackId:
        """The track of a group's lane."""
        return self._groups[group].tracks[lane]

    def leave(self, group: GroupId, lane: int) -> None:
        """Give a lane of a group back."""
        self._groups[group].busy[lane] = False

    def actor(self, entity: EntityId) -> Actor:
        """An entity; one that did not appear gets a name of its number."""
        known = self._actors.get(entity)
        if known is None:
            known = self._actors[entity] = self._actor(entity, self.participants.entities.get(entity))
        return known

    def waits(self, actor: Actor) -> TrackId:
        """The track of what an entity waits for."""
        if not actor.waits:
            topic = actor.facts.get("topic")
            name = f"{actor.name} ({topic})" if topic and topic != actor.name else actor.name
            actor.waits = self._add(TrackKind.LANE, name, self._group_track(actor.group))
        return actor.waits

    def queue(self, actor: Actor) -> TrackId:
        """The counter of an entity's queue."""
        if not actor.queue:
            name = f"queue of {actor.name}"
            actor.queue = self._add(TrackKind.COUNTER, name, self._group_track(actor.group), "messages")
        return actor.queue

    def service(self, name: str) -> TrackId:
        """The track of calls and replies outside callbacks."""
        return self._lane_in(SERVICES, name)

    def node(self, node: NodeId) -> TrackId:
        """The track of what a node publishes outside callbacks; 0 is the robot's driver."""
        if node == 0:
            return self._lane_in(ROBOT, "published by the robot")
        return self._lane_in(NODES, self.participants.nodes.get(node, f"node {node}"))

    def words(self, name: str) -> TrackId:
        """The track of the log, the commands or the notices."""
        return self._lane_in("", name)

    def measure(self, name: str, unit: str, t: Nanoseconds, value: float) -> None:
        """Let a counter of the robot have a value; nothing is written while it keeps it."""
        track, shown = self._counters.get(name, (0, None))
        if value == shown:
            return
        if not track:
            track = self._add(TrackKind.COUNTER, name, self._folder(ROBOT), unit)
        self._counters[name] = (track, value)
        self._sink.count(track, t, value)

    def _actor(self, entity: EntityId, known: Entity | None) -> Actor:
        if known is None:
            return Actor(f"callback {entity}", 0, None, 0, {"entity": f"entity {entity}"})
        facts: dict[str, str | int | float] = {"entity": known.kind.value}
        if known.name:
            facts["topic"] = printable(known.name)
        group = self.participants.groups.get(known.group)
        if group is not None:
            facts["group"] = group.letter
        facts["node"] = printable(self.participants.nodes.get(known.node, f"node {known.node}"))
        return Actor(printable(known.spoken_name), known.group, known.kind, known.depth, facts)

    def _process(self, process: ProcessId) -> TrackId:
        if process not in self._processes:
            name = self.participants.processes.get(process, self._title)
            self._processes[process] = self._add(TrackKind.PROCESS, name)
        return self._processes[process]

    def _lanes(self, group: GroupId) -> Lanes:
        if group not in self._groups:
            track = self._add(TrackKind.LANE, self._group_name(group), self._folder(GROUPS))
            self._groups[group] = Lanes([track], [False])
        return self._groups[group]

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

    def _lane_in(self, folder: str, name: str) -> TrackId:
        if (folder, name) not in self._named:
            parent = self._folder(folder) if folder else 0
            self._named[folder, name] = self._add(TrackKind.LANE, name, parent)
        return self._named[folder, name]

    def _add(self, kind: TrackKind, name: str, parent: TrackId = 0, unit: str = "") -> TrackId:
        self._made += 1
        self._sink.add(Track(self._made, kind, printable(name), parent, unit))
        return self._made
