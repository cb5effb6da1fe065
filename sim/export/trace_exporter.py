"""Translates events to the tracks, slices, instants, counters and arrows of trace viewers."""

from collections.abc import Callable, Sequence
from typing import Any

from sim.export.flows import Flows
from sim.export.open_calls import CallSegment, OpenCalls
from sim.export.reorder_buffer import PayloadKind, ReorderBuffer
from sim.export.texts import printable
from sim.export.trace_sink import NO_ARGS, NO_LINKS, Args, Arrows, TraceSink, TrackId
from sim.export.track_layout import TrackLayout
from sim.export.waits_of_calls import WaitsOfCalls
from sim.trace import events as ev
from sim.trace.descriptions import why_waiting
from sim.trace.events import AnyEvent, EntityId, EntityKind, ThreadId
from sim.trace.model import Nanoseconds

_UNFINISHED: Args = {"unfinished": "yes"}


class TraceExporter:
    """Writes events to a trace sink; memory does not grow with the length of the run.

    A thread's track has its calls, and within them the intervals in which ``Client.call`` blocks it. A
    group's tracks have its calls from start to end, suspensions included. An entity's track, below its group,
    has its waits with reason and culprit, and its lost messages. Not thread-safe.
    """

    def __init__(self, sink: TraceSink) -> None:
        self._sink = sink
        self._reordered = ReorderBuffer()
        self._layout = TrackLayout(sink)
        self._flows = Flows()
        self._open_calls = OpenCalls()
        self._waits = WaitsOfCalls()
        self._waiting: set[EntityId] = set()
        self._blocked: dict[ThreadId, ev.CallId] = {}
        self._handlers: dict[type, Callable[[Any], object]] = self._make_handlers()

    def take(self, events: Sequence[AnyEvent]) -> None:
        """Write a batch in order of time; the latest events stay in the reorder buffer."""
        self._handle_all(self._reordered.take(events))

    def finish(self) -> None:
        """Write the rest, and end the open slices."""
        self._handle_all(self._reordered.flush())
        self._end_open_slices(self._reordered.latest)
        self._sink.close()

    def _handle_all(self, events: Sequence[AnyEvent]) -> None:
        handlers = self._handlers
        for event in events:
            handle = handlers.get(event.__class__)
            if handle is not None:
                handle(event)

    def _make_handlers(self) -> dict[type, Callable[[Any], object]]:
        participants = self._layout.participants
        return {
            ev.RunStarted: self._run_started,
            ev.RunEnded: self._run_ended,
            ev.ProcessAppeared: participants.add_process,
            ev.ProcessEnded: self._process_ended,
            ev.ThreadAppeared: self._layout.add_thread,
            ev.ExecutorAppeared: self._executor_appeared,
            ev.NodeAppeared: participants.add_node,
            ev.GroupAppeared: self._group_appeared,
            ev.EntityAppeared: participants.add_entity,
            ev.EntityGone: self._entity_gone,
            ev.EntityReady: self._entity_ready,
            ev.MessageDropped: self._message_dropped,
            ev.WaitStarted: self._wait_started,
            ev.WaitEnded: self._wait_ended,
            ev.CallbackStarted: self._callback_started,
            ev.CallbackEnded: self._callback_ended,
            ev.CallbackSuspended: self._callback_suspended,
            ev.CallbackResumed: self._callback_resumed,
            ev.SpinClashed: self._spin_clashed,
            ev.TimesKept: self._times_kept,
            ev.CallbackFailed: self._open_calls.fail,
            ev.Published: self._published,
            ev.QosMismatched: self._qos_mismatched,
            ev.SynchroniserJudged: self._synchroniser_judged,
            ev.ServiceCalled: self._service_called,
            ev.ServiceReplied: self._service_replied,
            ev.RequestLost: self._request_lost,
            ev.CallBlocked: self._call_blocked,
            ev.CallUnblocked: self._call_unblocked,
            ev.Logged: self._logged,
            ev.Printed: self._printed,
            ev.RobotMoved: self._robot_moved,
            ev.VelocityCommanded: self._velocity_commanded,
            ev.CommandGiven: self._command_given,
            ev.TimeHalted: self._command_given,
            ev.Typed: self._typed,
            ev.LineGiven: self._command_given,
            ev.LineSaid: self._line_said,
            ev.Notice: self._noticed,
            ev.EventsLost: self._events_lost,
            ev.ContentsLost: self._contents_lost,
        }

    # the run

    def _run_started(self, event: ev.RunStarted) -> None:
        self._layout.begin(event.target)
        self._sink.begin_run(event.epoch)

    def _run_ended(self, event: ev.RunEnded) -> None:
        self._add_text("notices", event.t, f"the run ended: {event.reason}", {"failed": str(event.failed)})

    def _process_ended(self, event: ev.ProcessEnded) -> None:
        label = self._layout.participants.processes.get(event.process, "a program")
        self._add_text("notices", event.t, f"{label} ended: {event.reason}", {"status": event.status})

    def _executor_appeared(self, event: ev.ExecutorAppeared) -> None:
        self._add_text("notices", event.t, event.kind, {"threads": event.threads})

    def _group_appeared(self, event: ev.GroupAppeared) -> None:
        self._layout.participants.add_group(event)
        self._layout.add_group(event.group)

    def _events_lost(self, event: ev.EventsLost) -> None:
        self._open_calls.mark_uncertain()
        self._add_text("notices", event.t, f"{event.count} events lost so far", NO_ARGS)

    def _contents_lost(self, event: ev.ContentsLost) -> None:
        self._add_text("notices", event.t, f"contents of {event.count} messages lost so far", NO_ARGS)

    # queues and waits

    def _entity_ready(self, event: ev.EntityReady) -> None:
        self._waits.arrive(event)
        self._reordered.forget(event)
        left = tuple(self._flows.arrive(event.message, event.entity, event.depth))
        if left:
            self._lose(event.entity, event.t, "left the queue", left)
        self._show_depth(event.entity, event.t, event.depth)

    def _message_dropped(self, event: ev.MessageDropped) -> None:
        self._waits.lose(event)
        self._lose(event.entity, event.t, "lost", self._flows.take(event.message, event.entity))
        self._show_depth(event.entity, event.t, event.depth)

    def _lose(self, entity: EntityId, t: Nanoseconds, what: str, flows: tuple[int, ...]) -> None:
        track = self._layout.waits(self._layout.entity(entity))
        self._sink.instant(track, t, what, "queue", NO_ARGS, Arrows(end=flows))

    def _show_depth(self, entity: EntityId, t: Nanoseconds, depth: int) -> None:
        shown = self._layout.entity(entity)
        if shown.shown_depth == depth or not shown.depth:
            return
        shown.shown_depth = depth
        self._sink.count(self._layout.queue(shown), t, depth)

    def _entity_gone(self, event: ev.EntityGone) -> None:
        self._stop_waiting(event.entity, event.t)
        flows = self._flows.empty(event.entity)
        if flows:
            self._lose(event.entity, event.t, "destroyed", flows)

    def _wait_started(self, event: ev.WaitStarted) -> None:
        self._stop_waiting(event.entity, event.t)
        self._waiting.add(event.entity)
        entity = self._layout.entity(event.entity)
        wait = self._waits.start(event)
        args: dict[str, str | int | float] = {
            "reason": event.reason.value,
            "ready_since_s": event.since / 1e9,
            "workers_busy": "yes" if event.workers_busy else "no",
        }
        if event.holder:
            args["culprit"] = self._layout.entity(event.holder).name
        name = printable(why_waiting(wait, self._layout.participants))
        self._sink.begin(self._layout.waits(entity), event.t, name, "wait", args)

    def _wait_ended(self, event: ev.WaitEnded) -> None:
        self._waits.end(event)
        self._stop_waiting(event.entity, event.t)

    def _stop_waiting(self, entity: EntityId, t: Nanoseconds) -> None:
        if entity in self._waiting:
            self._waiting.remove(entity)
            self._sink.end(self._layout.waits(self._layout.entity(entity)), t)

    # calls

    def _callback_started(self, event: ev.CallbackStarted) -> None:
        for segment in self._open_calls.ended_unseen(event.thread):
            self._end_span(segment, event.t)
            self._end_call(segment, event.t)
        self._unblock(event.thread, event.t)
        segment = self._open_calls.start(event, self._waits.before(event))
        entity = self._layout.entity(event.entity)
        args = {
            **entity.args,
            "late_ms" if entity.kind is EntityKind.TIMER else "message_age_ms": event.age / 1e6,
            "waited_ms": segment.wait / 1e6,
            "queue_depth": event.depth,
        }
        through = self._flows.served(event.message) if entity.kind is EntityKind.SERVICE else ()
        taken = self._flows.take(event.message, event.entity)
        links = Arrows((), through, taken) if through or taken else NO_LINKS
        self._sink.begin(self._layout.thread(event.thread), event.t, entity.name, "callback", args, links)
        segment.lane = self._layout.enter(entity.group)
        on = {"thread": self._layout.thread_name(event.thread)}
        self._sink.begin(self._layout.lane(entity.group, segment.lane), event.t, entity.name, "group", on)
        self._show_depth(event.entity, event.t, event.depth)

    def _callback_ended(self, event: ev.CallbackEnded) -> None:
        left = self._open_calls.finish(event)
        for segment in left:
            self._end_span(segment, event.t)
            self._end_call(segment, event.t)
        suspended = None if left else self._open_calls.finish_suspended(event.entity)
        if suspended is not None:
            self._sink.end(self._lane_of(suspended), event.t)
            self._end_call(suspended, event.t)

    def _callback_suspended(self, event: ev.CallbackSuspended) -> None:
        left = self._open_calls.suspend(event)
        for segment in left:
            self._end_span(segment, event.t)
        for lost in left[:-1]:
            self._end_call(lost, event.t)
        if left:
            self._sink.begin(self._lane_of(left[-1]), event.t, "suspended", "group", NO_ARGS)

    def _callback_resumed(self, event: ev.CallbackResumed) -> None:
        self._unblock(event.thread, event.t)
        segment, before = self._open_calls.resume(event)
        entity = self._layout.entity(event.entity)
        if before is None:
            segment.lane = self._layout.enter(entity.group)
            self._sink.begin(self._lane_of(segment), event.t, entity.name, "group", NO_ARGS)
        else:
            self._sink.end(self._lane_of(segment), event.t)
        args = {**entity.args, "resumed": "yes"}
        self._sink.begin(self._layout.thread(event.thread), event.t, entity.name, "callback", args)

    def _end_span(self, segment: CallSegment, t: Nanoseconds, args: Args = NO_ARGS) -> None:
        """End the slice of a segment on its thread."""
        self._unblock(segment.thread, t)
        if segment.error:
            args = {**args, "error": printable(segment.error)}
        self._sink.end(self._layout.thread(segment.thread), t, args)

    def _end_call(self, segment: CallSegment, t: Nanoseconds, args: Args = NO_ARGS) -> None:
        """End the slice of a call in its group."""
        self._sink.end(self._lane_of(segment), t, args)
        self._layout.leave(self._layout.entity(segment.entity).group, segment.lane)

    def _lane_of(self, segment: CallSegment) -> TrackId:
        return self._layout.lane(self._layout.entity(segment.entity).group, segment.lane)

    def _spin_clashed(self, event: ev.SpinClashed) -> None:
        text = f"{event.function}() asks to spin what is being spun"
        self._add_text("notices", event.t, text, {"line": event.line})

    def _times_kept(self, event: ev.TimesKept) -> None:
        text = f"a clock was set back, and {', '.join(map(printable, event.attributes))} kept"
        self._add_text("notices", event.t, text, {"by": event.length / 1e9})

    # messages and services

    def _published(self, event: ev.Published) -> None:
        flows = self._flows.send(event.message, self._reordered.receivers(PayloadKind.MESSAGE, event.message))
        track = self._thread_track(event.entity)
        if track is None:
            track = self._layout.node(event.node)
        name = f"publish {printable(event.topic)}"
        self._sink.instant(track, event.t, name, "publish", {"message": event.message}, Arrows(begin=flows))

    def _qos_mismatched(self, event: ev.QosMismatched) -> None:
        args: Args = {"topic": printable(event.topic), "policy": event.policy}
        self._add_text(
            "notices", event.t, f"{printable(event.topic)}: quality of service does not match", args
        )

    def _synchroniser_judged(self, event: ev.SynchroniserJudged) -> None:
        topics = ", ".join(map(printable, event.topics))
        text = f"synchroniser of {topics}: {'a set' if event.matched else 'nothing'} is handed on"
        self._add_text("notices", event.t, text, {"line": event.made_at[1]})

    def _request_lost(self, event: ev.RequestLost) -> None:
        track = self._layout.service(event.service)
        name = f"nobody offers {printable(event.service)}"
        self._sink.instant(track, event.t, name, "call", {"call": event.call})

    def _service_called(self, event: ev.ServiceCalled) -> None:
        to_service = self._flows.send(event.call, self._reordered.receivers(PayloadKind.REQUEST, event.call))
        flows = self._flows.call(event.call) + to_service
        track = self._thread_track(event.entity)
        if track is None:
            track = self._layout.service(event.service)
        args: Args = {"call": event.call, "request": printable(event.request)}
        self._sink.instant(
            track, event.t, f"call {printable(event.service)}", "call", args, Arrows(begin=flows)
        )

    def _service_replied(self, event: ev.ServiceReplied) -> None:
        to_client = self._flows.send(event.call, self._reordered.receivers(PayloadKind.REPLY, event.call))
        track = self._serving(event.service)
        args: Args = {"call": event.call, "response": printable(event.response)}
        links = Arrows(begin=to_client, end=self._flows.reply(event.call))
        self._sink.instant(track, event.t, f"reply {printable(event.service)}", "call", args, links)

    def _serving(self, service: str) -> TrackId:
        """The track of a reply: the thread that runs the service's callback, if one does."""
        for entity in self._layout.participants.entities.values():
            if entity.kind is EntityKind.SERVICE and entity.name == service:
                track = self._thread_track(entity.id)
                if track is not None:
                    return track
        return self._layout.service(service)

    def _thread_track(self, entity: EntityId) -> TrackId | None:
        thread = self._open_calls.thread_of(entity) if entity else None
        return None if thread is None else self._layout.thread(thread)

    def _call_blocked(self, event: ev.CallBlocked) -> None:
        self._unblock(event.thread, event.t)
        self._blocked[event.thread] = event.call
        name = f"blocked in a call of {printable(event.service)}"
        self._sink.begin(self._layout.thread(event.thread), event.t, name, "call", {"call": event.call})

    def _call_unblocked(self, event: ev.CallUnblocked) -> None:
        if self._blocked.get(event.thread) == event.call:
            self._unblock(event.thread, event.t)

    def _unblock(self, thread: ThreadId, t: Nanoseconds) -> None:
        if self._blocked.pop(thread, None) is not None:
            self._sink.end(self._layout.thread(thread), t)

    # texts and the robot

    def _logged(self, event: ev.Logged) -> None:
        args: dict[str, str | int | float] = {
            "severity": event.severity.value,
            "logger": printable(event.logger),
        }
        if event.thread:
            args["thread"] = self._layout.thread_name(event.thread)
        if event.entity:
            args["callback"] = self._layout.entity(event.entity).name
        self._add_text("log", event.t, event.text, args)

    def _printed(self, event: ev.Printed) -> None:
        self._add_text("log", event.t, event.text, {"severity": "stderr" if event.error else "stdout"})

    def _command_given(self, event: ev.CommandGiven | ev.LineGiven | ev.TimeHalted) -> None:
        self._add_text("commands", event.t, event.text, NO_ARGS)

    def _typed(self, event: ev.Typed) -> None:
        self._add_text("commands", event.t, f"typed {event.text!r}", NO_ARGS)

    def _line_said(self, event: ev.LineSaid) -> None:
        self._add_text("commands", event.t, event.text, {"line": event.line})

    def _noticed(self, event: ev.Notice) -> None:
        self._add_text("notices", event.t, event.text, {"severity": event.severity.value})

    def _add_text(self, track: str, t: Nanoseconds, text: str, args: Args) -> None:
        self._sink.instant(self._layout.text_lane(track), t, printable(text) or "(empty line)", track, args)

    def _robot_moved(self, event: ev.RobotMoved) -> None:
        measure = self._layout.set_robot_counter
        measure("x", "m", event.t, event.x)
        measure("y", "m", event.t, event.y)
        measure("yaw", "rad", event.t, event.yaw)
        measure("linear velocity", "m/s", event.t, event.linear)
        measure("angular velocity", "rad/s", event.t, event.angular)

    def _velocity_commanded(self, event: ev.VelocityCommanded) -> None:
        self._layout.set_robot_counter("commanded linear velocity", "m/s", event.t, event.linear)
        self._layout.set_robot_counter("commanded angular velocity", "rad/s", event.t, event.angular)

    # the end

    def _end_open_slices(self, t: Nanoseconds) -> None:
        for entity in list(self._waiting):
            self._stop_waiting(entity, t)
        for segment in self._open_calls.running():
            self._end_span(segment, t, _UNFINISHED)
            self._end_call(segment, t, _UNFINISHED)
        for segment in self._open_calls.suspended():
            self._sink.end(self._lane_of(segment), t)
            self._end_call(segment, t, _UNFINISHED)
        for thread in list(self._blocked):
            self._unblock(thread, t)
        for entity in self._flows.receivers():
            flows = self._flows.empty(entity)
            if flows:
                self._lose(entity, t, "still in the queue", flows)
        unanswered = self._flows.unanswered()
        if unanswered:
            track = self._layout.text_lane("notices")
            self._sink.instant(track, t, "calls without a reply", "call", NO_ARGS, Arrows(end=unanswered))
