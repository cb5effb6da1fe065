"""Events as JSON, one object a line, with names instead of ids: what ``--events`` writes.

``sim/trace/EVENTS.md`` lists every event and its fields.
"""

from collections.abc import Callable, Iterable, Iterator
from typing import Any, TypeAlias

import msgspec

from sim.trace import events as ev
from sim.trace.cast import Cast
from sim.trace.events import AnyEvent, EntityId, GroupId, MessageId, NodeId, ThreadId, TopicId

Line: TypeAlias = dict[str, object]

ROBOT = "robot"
"""What stands for the node of the robot's driver, which is none of the learner's program."""


class JsonLines:
    """Turns events, fed in order, into lines of JSON.

    Every line has ``t`` (seconds) and ``event`` first; then come those fields that apply, always in the same
    order. Fields without a value are left out; infinite numbers and NaN become null. Not thread-safe.
    """

    def __init__(self) -> None:
        self._cast = Cast()
        self._about: dict[EntityId, Line] = {}
        self._topics: dict[TopicId, str] = {}
        self._encode = msgspec.json.Encoder().encode
        self._fields = {kind: (kind.__struct_config__.tag, fields) for kind, fields in self._table().items()}

    def lines(self, events: Iterable[AnyEvent]) -> Iterator[bytes]:
        """One line for each event but ``TimePassed``, ended by a newline."""
        encode, fields = self._encode, self._fields
        for event in events:
            if event.__class__ is ev.TimePassed:
                continue
            name, describe = fields[event.__class__]
            yield encode({"t": event.t / 1e9, "event": name, **describe(event)}) + b"\n"

    def _table(self) -> dict[type[AnyEvent], Callable[[Any], Line]]:
        return {
            ev.RunStarted: _run_started,
            ev.RunEnded: _run_ended,
            ev.RunEnding: _run_ending,
            ev.ProcessAppeared: self._process_appeared,
            ev.ProcessEnded: self._process_ended,
            ev.ThreadAppeared: self._thread_appeared,
            ev.ExecutorAppeared: _executor_appeared,
            ev.NodeAppeared: self._node_appeared,
            ev.GroupAppeared: self._group_appeared,
            ev.EntityAppeared: self._entity_appeared,
            ev.EntityGone: self._about_entity,
            ev.EntityReady: self._queued,
            ev.MessageDropped: self._queued,
            ev.WaitStarted: self._wait_started,
            ev.WaitEnded: self._about_entity,
            ev.CallbackStarted: self._callback_started,
            ev.CallbackEnded: self._on_thread,
            ev.CallbackSuspended: self._on_thread,
            ev.CallbackResumed: self._on_thread,
            ev.SpinClashed: self._spin_clashed,
            ev.CallbackFailed: self._callback_failed,
            ev.Published: self._published,
            ev.QosMismatched: self._qos_mismatched,
            ev.TopicAppeared: self._topic_appeared,
            ev.MessageSent: self._message_sent,
            ev.ServiceCalled: self._service_called,
            ev.ServiceReplied: _service_replied,
            ev.RequestLost: _request_lost,
            ev.CallBlocked: self._call_blocked,
            ev.CallUnblocked: self._call_unblocked,
            ev.Logged: self._logged,
            ev.Printed: self._printed,
            ev.RobotMoved: _robot_moved,
            ev.ArenaShown: _arena_shown,
            ev.Scanned: _scanned,
            ev.VelocityCommanded: _velocity_commanded,
            ev.CommandGiven: _command_given,
            ev.InputGiven: _input_given,
            ev.TimeHalted: _time_halted,
            ev.KeyboardAsked: _keyboard_asked,
            ev.Typed: _typed,
            ev.LineGiven: _line_given,
            ev.LineSaid: _line_said,
            ev.LineEnded: _line_ended,
            ev.LineCompleted: _line_completed,
            ev.Notice: self._notice,
            ev.EventsLost: _lost,
            ev.ContentsLost: _lost,
        }

    # the cast

    def _process_appeared(self, event: ev.ProcessAppeared) -> Line:
        self._cast.add_process(event)
        return {"process": event.label}

    def _process_ended(self, event: ev.ProcessEnded) -> Line:
        return {**self._process(event.process), "reason": event.reason, "status": event.status}

    def _process(self, process: ev.ProcessId) -> Line:
        label = self._cast.processes.get(process)
        return {} if label is None else {"process": label}

    def _thread_appeared(self, event: ev.ThreadAppeared) -> Line:
        self._cast.add_thread(event)
        return {**self._process(event.process), "thread": event.name}

    def _node_appeared(self, event: ev.NodeAppeared) -> Line:
        self._cast.add_node(event)
        return {"node": event.name}

    def _group_appeared(self, event: ev.GroupAppeared) -> Line:
        self._cast.add_group(event)
        return {
            "node": self._node(event.node),
            **self._group(event.group),
            "class_name": event.class_name,
        }

    def _entity_appeared(self, event: ev.EntityAppeared) -> Line:
        entity = self._cast.add_entity(event)
        about: Line = {"node": self._node(entity.node)}
        if entity.callback:
            about["callback"] = entity.callback
        about["kind"] = entity.kind.value
        about["entity"] = entity.name or entity.spoken_name
        about |= self._group(entity.group)
        self._about[event.entity] = about
        return {
            **about,
            "depth": event.depth,
            "period": event.period / 1e9,
            "file": event.file,
            "first_line": event.first_line,
            "last_line": event.last_line,
        }

    def _node(self, node: NodeId) -> str:
        return self._cast.nodes.get(node, ROBOT if node == 0 else f"node {node}")

    def _group(self, group: GroupId) -> Line:
        known = self._cast.groups.get(group)
        return {} if known is None else {"group": known.letter, "group_type": known.kind.value}

    def _thread(self, thread: ThreadId) -> str:
        known = self._cast.threads.get(thread)
        return f"thread {thread}" if known is None else known.name

    def _callback(self, entity: EntityId) -> str | None:
        known = self._cast.entities.get(entity)
        return None if known is None else known.spoken_name

    # entities and their callbacks

    def _about_entity(self, event: ev.EntityGone | ev.WaitEnded) -> Line:
        return self._about.get(event.entity, {})

    def _queued(self, event: ev.EntityReady | ev.MessageDropped) -> Line:
        return {
            **self._about.get(event.entity, {}),
            "depth": event.depth,
            **_message_id(event.message),
        }

    def _wait_started(self, event: ev.WaitStarted) -> Line:
        line: Line = {**self._about.get(event.entity, {}), "reason": event.reason.value}
        holder = self._callback(event.holder)
        if holder is not None:
            line["held_by"] = holder
        line["since"] = event.since / 1e9
        line["workers_busy"] = event.workers_busy
        return line

    def _callback_started(self, event: ev.CallbackStarted) -> Line:
        return {
            **self._about.get(event.entity, {}),
            "thread": self._thread(event.thread),
            "depth": event.depth,
            "age": event.age / 1e9,
            **_message_id(event.message),
        }

    def _on_thread(self, event: ev.CallbackEnded | ev.CallbackSuspended | ev.CallbackResumed) -> Line:
        return {**self._about.get(event.entity, {}), "thread": self._thread(event.thread)}

    def _callback_failed(self, event: ev.CallbackFailed) -> Line:
        return {
            **self._about.get(event.entity, {}),
            "thread": self._thread(event.thread),
            "message": event.error,
            "file": event.file,
            "line": event.line,
        }

    def _spin_clashed(self, event: ev.SpinClashed) -> Line:
        node: Line = {"node": self._node(event.node)} if event.node else {}
        place: Line = {"file": event.file, "line": event.line} if event.file else {}
        return {**node, **self._by_callback(event.entity), "function": event.function, **place}

    # messages, calls and lines

    def _published(self, event: ev.Published) -> Line:
        return {
            "node": self._node(event.node),
            **self._by_callback(event.entity),
            "entity": event.topic,
            "message_id": event.message,
        }

    def _qos_mismatched(self, event: ev.QosMismatched) -> Line:
        ends = {"publisher": event.publisher, "subscription": event.subscription}
        return {
            "node": self._node(event.node),
            **self._by_callback(event.entity),
            "entity": event.topic,
            "policy": event.policy,
            **{name: f"{end[0]}:{end[1]}" for name, end in ends.items() if end[0]},
        }

    def _topic_appeared(self, event: ev.TopicAppeared) -> Line:
        self._topics[event.topic] = event.name
        return {"entity": event.name, "type": event.message_type, "definition": event.definition}

    def _message_sent(self, event: ev.MessageSent) -> Line:
        topic = self._topics.get(event.topic, f"topic {event.topic}")
        size: Line = {} if event.data is None else {"size": len(event.data)}
        return {"entity": topic, "message_id": event.message, **size}

    def _service_called(self, event: ev.ServiceCalled) -> Line:
        return {
            **self._by_callback(event.entity),
            "entity": event.service,
            "call": event.call,
            "request": event.request,
        }

    def _call_blocked(self, event: ev.CallBlocked) -> Line:
        return {
            **self._by_callback(event.entity),
            "entity": event.service,
            "thread": self._thread(event.thread),
            "call": event.call,
        }

    def _call_unblocked(self, event: ev.CallUnblocked) -> Line:
        return {"thread": self._thread(event.thread), "call": event.call}

    def _logged(self, event: ev.Logged) -> Line:
        line: Line = {"node": event.logger, **self._by_callback(event.entity)}
        if event.thread:
            line["thread"] = self._thread(event.thread)
        line["message"] = event.text
        line["severity"] = event.severity.value
        return line

    def _printed(self, event: ev.Printed) -> Line:
        return {**self._process(event.process), "message": event.text, "error": event.error}

    def _notice(self, event: ev.Notice) -> Line:
        about = self._by_callback(event.entity)
        return {**about, "message": event.text, "severity": event.severity.value}

    def _by_callback(self, entity: EntityId) -> Line:
        callback = self._callback(entity)
        return {} if callback is None else {"callback": callback}


def _message_id(message: MessageId) -> Line:
    return {"message_id": message} if message else {}


def _run_started(event: ev.RunStarted) -> Line:
    return {"target": event.target, "clock": event.clock, "epoch": event.epoch / 1e9}


def _run_ended(event: ev.RunEnded) -> Line:
    return {"reason": event.reason, "failed": event.failed}


def _run_ending(event: ev.RunEnding) -> Line:
    return {"reason": event.reason}


def _executor_appeared(event: ev.ExecutorAppeared) -> Line:
    return {"kind": event.kind, "threads": event.threads}


def _service_replied(event: ev.ServiceReplied) -> Line:
    return {"entity": event.service, "call": event.call, "response": event.response}


def _request_lost(event: ev.RequestLost) -> Line:
    return {"entity": event.service, "call": event.call}


def _robot_moved(event: ev.RobotMoved) -> Line:
    return {
        "x": event.x,
        "y": event.y,
        "yaw": event.yaw,
        "front": event.front,
        "linear": event.linear,
        "angular": event.angular,
        "motors": event.motors,
        "touching": event.touching,
        "turned": event.turned,
        "travelled": event.travelled,
    }


def _arena_shown(event: ev.ArenaShown) -> Line:
    return {"walls": event.walls, "sphere": event.sphere, "robot_radius": event.robot_radius}


def _scanned(event: ev.Scanned) -> Line:
    """Of a scan only the range straight ahead: all of them would outweigh the rest of the file."""
    beams = len(event.ranges) // 2
    ahead = int.from_bytes(event.ranges[beams : beams + 2], "little")
    return {"beams": beams, "front": ahead / 1000 if ahead else None, "message_id": event.message}


def _velocity_commanded(event: ev.VelocityCommanded) -> Line:
    return {"linear": event.linear, "angular": event.angular}


def _command_given(event: ev.CommandGiven) -> Line:
    return {"message": event.text}


def _input_given(event: ev.InputGiven) -> Line:
    return {"message": event.command}


def _time_halted(event: ev.TimeHalted) -> Line:
    return {"message": event.text}


def _keyboard_asked(event: ev.KeyboardAsked) -> Line:
    return {"program": event.program, "reads": event.reads.value}


def _typed(event: ev.Typed) -> Line:
    return {"message": event.text}


def _line_given(event: ev.LineGiven) -> Line:
    return {"line": event.line, "message": event.text}


def _line_said(event: ev.LineSaid) -> Line:
    return {"line": event.line, "message": event.text, "error": event.error}


def _line_ended(event: ev.LineEnded) -> Line:
    return {"line": event.line, "status": event.status}


def _line_completed(event: ev.LineCompleted) -> Line:
    return {"line": event.line, "start": event.start, "words": event.words}


def _lost(event: ev.EventsLost | ev.ContentsLost) -> Line:
    return {"count": event.count}
