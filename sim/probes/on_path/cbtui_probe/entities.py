"""Hooks that record nodes, callback groups and entities as they are created and destroyed."""

from __future__ import annotations

import inspect
import sys
import time
import weakref
from functools import wraps
from types import CodeType
from typing import TYPE_CHECKING, Any

from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.qos import QoSPolicyKind

from .callbacks import Calls, is_own, is_own_module
from .naming import code_of, module_of, owner_of, written_at
from .parameters import watch_parameters
from .recorder import now
from .states import STATE, WatchedEntity, nothing, state_of
from .unseen import UNSEEN, leave_out_probe

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import FrameType

    from .recorder import Recorder
    from .tuning import Tuning

_INCOMPATIBLE = "RCL_SUBSCRIPTION_REQUESTED_INCOMPATIBLE_QOS"


def _type_of(made: Any) -> str:
    """The type of an entity's topic or service, such as ``std_srvs/srv/SetBool``; "" if it has neither."""
    made_for = getattr(made, "srv_type", None) or getattr(made, "msg_type", None)
    if made_for is None:
        return ""
    kind = made_for if isinstance(made_for, type) else type(made_for)  # rclpy takes a message for its class
    return "/".join([*kind.__module__.split(".")[:2], kind.__name__])


class NoGroup:
    """Stands on the trace for the group of what is in none."""


class _Task:
    """A stand-in for a function that executors run as a task, which is no entity of rclpy's."""

    def __init__(self) -> None:
        self.callback_group = NoGroup()


class Entities:
    """Hooks the methods by which nodes create and destroy entities. ``nodes`` has all nodes."""

    def __init__(self, recorder: Recorder, tuning: Tuning) -> None:
        self._recorder = recorder
        self._tuning = tuning
        self.nodes: weakref.WeakSet[Any] = weakref.WeakSet()

    def watch(self, node_class: Any) -> None:
        """Record the nodes of this class, and what they create."""
        make_node = node_class.__init__
        entities = self

        @wraps(make_node)
        def init(node: Any, *args: Any, **kwargs: Any) -> None:
            with UNSEEN:
                make_node(node, *args, **kwargs)
            entities.node_made(node)

        node_class.__init__ = init
        for kind in ("timer", "subscription", "service", "client", "guard_condition"):
            self._watch_making(node_class, kind)
            self._watch_destroying(node_class, kind)
        self._watch_rates(node_class)
        self._watch_publishers(node_class)
        self._watch_waitables(node_class)
        watch_parameters(node_class, self._recorder)

    def watch_rhythms(self, timer_class: Any) -> None:
        """Follow changes of timers' periods and resets, which change when a timer is due."""
        period, reset = timer_class.timer_period_ns, timer_class.reset

        def change(timer: Any, nanoseconds: int) -> None:
            with UNSEEN:
                period.fset(timer, nanoseconds)
            if (entity := state_of(timer)) is not None:
                entity.period = nanoseconds

        @wraps(reset)
        def reset_known(timer: Any) -> None:
            if (entity := state_of(timer)) is not None:
                entity.due = 0
            with UNSEEN:
                reset(timer)

        timer_class.timer_period_ns = property(period.fget, change, doc=period.__doc__)
        timer_class.reset = reset_known

    def node_made(self, node: Any) -> int:
        """Record a node, unless that is done; returns its id."""
        if state_of(node) is None:
            number = self._recorder.new_id()
            setattr(node, STATE, number)
            self._recorder.put("node", now(), number, node.get_fully_qualified_name())
            self.nodes.add(node)
        return int(state_of(node))

    def _watch_making(self, node_class: Any, kind: str) -> None:
        make = getattr(node_class, f"create_{kind}")
        signature = inspect.signature(make)

        @wraps(make)
        def create(node: Any, *args: Any, **kwargs: Any) -> Any:
            if not (is_own(sys._getframe(1)) or _hears_clock(sys._getframe(1))):
                return make(node, *args, **kwargs)
            try:
                bound = signature.bind(node, *args, **kwargs)
            except TypeError:
                bound = None
            if bound is None:
                with UNSEEN:
                    return make(node, *args, **kwargs)  # which says what is wrong
            entity = WatchedEntity("guard" if kind == "guard_condition" else kind)
            callback = bound.arguments.get("callback")
            if self._tuning.has_changes:
                self._tuning.change(node, kind, _called(node, kind, bound.arguments), bound.arguments)
            if callable(callback):
                bound.arguments["callback"] = self._traced(entity, callback)
            with UNSEEN:
                made = make(*bound.args, **bound.kwargs)
            place = _place(sys._getframe(1))
            self._know(node, made, entity, callback, place=place)
            if kind == "subscription":
                self._watch_matching(made, entity.number, place)
            if kind == "guard_condition":
                _watch_triggering(made, entity)
            return made

        setattr(node_class, f"create_{kind}", create)

    def _traced(self, entity: WatchedEntity, callback: Callable[..., Any]) -> Any:
        calls = Calls(self._recorder, entity)
        if entity.kind == "subscription":
            return calls.traced_with_info(callback)
        begin = {"timer": calls.begin_timer, "service": calls.begin_service, "guard": calls.begin_guard}
        return calls.traced(callback, begin.get(entity.kind))

    def _know(
        self,
        node: Any,
        made: Any,
        entity: WatchedEntity,
        callback: Callable[..., Any] | None,
        name: str = "",
        place: tuple[str, int] = ("", 0),
        known_as: str = "",
    ) -> None:
        """Record an entity; ``known_as`` is the callback's name if that of its function says little."""
        recorder = self._recorder
        callback_name, *written = written_at(callback)
        group = self._group_id(made.callback_group, self.node_made(node))
        number = entity.number = recorder.new_id()
        depth = getattr(getattr(made, "qos_profile", None), "depth", 0)
        if entity.kind == "timer":
            entity.period = made.timer_period_ns
        recorder.put(
            "entity",
            now(),
            number,
            state_of(node),
            group,
            entity.kind,
            name or _name_of(entity.kind, made),
            known_as or callback_name,
            *written,
            0 if entity.kind == "timer" else depth,
            entity.period,
            _type_of(made),
            place,
        )
        if entity.kind == "timer" and not made.is_canceled():
            entity.due = now() + made.time_until_next_call()
        setattr(made, STATE, entity)
        entity.made = weakref.ref(made)

    def _watch_matching(self, subscription: Any, number: int, place: tuple[str, int]) -> None:
        """Record publishers whose QoS is incompatible with that of a subscription created at ``place``."""
        topic = subscription.topic_name
        for handler in subscription.event_handlers:
            if handler.event_type.name == _INCOMPATIBLE:

                def tell(info: Any, callback: Callable[[Any], Any] = handler.callback) -> Any:
                    policy = QoSPolicyKind(info.last_policy_kind).name
                    node, _, publisher = self._publisher_of(topic)
                    self._recorder.put("qos_mismatch", now(), topic, node, number, policy, publisher, place)
                    return callback(info)

                handler.callback = tell

    def _publisher_of(self, topic: str) -> tuple[int, str, tuple[str, int]]:
        """The state of the first publisher of a topic in this process; empty if another process has it."""
        known = (state_of(publisher) for node in list(self.nodes) for publisher in node.publishers)
        return next((each for each in known if each is not None and each[1] == topic), (0, "", ("", 0)))

    def _group_id(self, group: Any, node: int) -> int:
        if state_of(group) is None:
            number = self._recorder.new_id()
            setattr(group, STATE, number)
            kind = "custom"
            if type(group) is MutuallyExclusiveCallbackGroup:
                kind = "exclusive"
            elif type(group) is ReentrantCallbackGroup:
                kind = "reentrant"
            elif type(group) is NoGroup:
                kind = "no group"
            self._recorder.put("group", now(), number, node, kind, type(group).__name__)
        return int(state_of(group))

    def _watch_destroying(self, node_class: Any, kind: str) -> None:
        destroy = getattr(node_class, f"destroy_{kind}")
        recorder = self._recorder

        @wraps(destroy)
        def destroy_known(node: Any, thing: Any) -> Any:
            entity = state_of(thing)
            if entity is not None and entity.made() is not None:
                entity.made = nothing
                entity.waits_no_more(recorder)
                recorder.put("entity_gone", now(), entity.number)
            with UNSEEN:
                return destroy(node, thing)

        setattr(node_class, f"destroy_{kind}", destroy_known)

    def _watch_rates(self, node_class: Any) -> None:
        """Record the timers of rates, which rclpy itself creates: ``Rate.sleep`` waits for them."""
        make = node_class.create_rate

        @wraps(make)
        def create_rate(node: Any, *args: Any, **kwargs: Any) -> Any:
            with UNSEEN:
                rate = make(node, *args, **kwargs)
            timer, entity = rate._timer, WatchedEntity("timer")
            timer.callback = self._traced(entity, timer.callback)
            self._know(node, timer, entity, rate.sleep, place=_place(sys._getframe(1)), known_as="tick")
            return rate

        node_class.create_rate = create_rate

    def _watch_publishers(self, node_class: Any) -> None:
        make = node_class.create_publisher

        @wraps(make)
        def create_publisher(node: Any, *args: Any, **kwargs: Any) -> Any:
            with UNSEEN:
                made = make(node, *args, **kwargs)
            if is_own(sys._getframe(1)):
                setattr(made, STATE, (self.node_made(node), made.topic_name, _place(sys._getframe(1))))
            return made

        node_class.create_publisher = create_publisher

    def watch_publishing(self, publisher_class: Any) -> None:
        """Record the messages of the program's own publishers."""
        publish, recorder = publisher_class.publish, self._recorder

        @wraps(publish)
        def publish_known(publisher: Any, msg: Any) -> None:
            known = state_of(publisher)
            began, before = now(), time.time_ns()
            try:
                publish(publisher, msg)
            except BaseException as error:
                leave_out_probe(error)
                raise
            if known is None:
                return
            node, topic, _ = known
            entity = recorder.here.entity
            recorder.put("sent", began, recorder.new_id(), topic, node, entity, before, time.time_ns())

        publisher_class.publish = publish_known

    def _watch_waitables(self, node_class: Any) -> None:
        """Record action servers and clients, and the program's own waitables."""
        add = node_class.add_waitable

        @wraps(add)
        def add_waitable(node: Any, waitable: Any) -> None:
            module = type(waitable).__module__
            is_action = module.startswith("rclpy.action.")
            if state_of(waitable) is None and (is_action or not module.startswith("rclpy")):
                name = ""
                if is_action:  # a server does not keep its name: it is an argument of what calls this
                    name = node.resolve_service_name(sys._getframe(1).f_locals["action_name"])
                entity = WatchedEntity("waitable")
                waitable.execute = Calls(self._recorder, entity).traced(waitable.execute)
                is_server = hasattr(waitable, "_execute_callback")
                end = f" {'server' if is_server else 'client'}" if is_action else ""
                self._know(node, waitable, entity, None, f"{name}{end}")
                if is_server:
                    self._know_execution(node, waitable, name)
            add(node, waitable)

        node_class.add_waitable = add_waitable

    def _know_execution(self, node: Any, server: Any, name: str) -> None:
        """Record the execute callback of an action server, which rclpy runs as a task, in no group."""
        entity, callback = WatchedEntity("waitable"), server._execute_callback
        server._execute_callback = Calls(self._recorder, entity).traced(callback)
        self._know(node, _Task(), entity, callback, name)

    def watch_tasks(self, executor_class: Any) -> None:
        """Record the program's functions that executors run as tasks, such as done-callbacks, in no group."""
        create, known = executor_class.create_task, dict[tuple[CodeType, int], WatchedEntity]()

        @wraps(create)
        def create_known(executor: Any, callback: Any, *args: Any, **kwargs: Any) -> Any:
            code, owner = code_of(callback), owner_of(callback)
            first = next(iter(executor.get_nodes()), None)
            node = next((each for each in self.nodes if each is owner), first)
            if code is not None and is_own_module(module_of(callback)) and node is not None:
                key = code, id(node)
                if key not in known:
                    known[key] = WatchedEntity("task")
                    self._know(node, _Task(), known[key], callback, "")
                calls = Calls(self._recorder, known[key])
                trace = calls.traced_coroutine if inspect.iscoroutine(callback) else calls.traced
                callback = trace(callback)
            return create(executor, callback, *args, **kwargs)

        executor_class.create_task = create_known


def _watch_triggering(guard: Any, entity: WatchedEntity) -> None:
    """Keep when a guard condition was triggered: a wait set of the probe's own would reset it."""
    trigger = guard.trigger

    @wraps(trigger)
    def trigger_known() -> None:
        entity.due = entity.due or now()
        trigger()

    guard.trigger = trigger_known


def _hears_clock(frame: FrameType) -> bool:
    """Whether rclpy subscribes a node to ``/clock`` there: simulated time goes on by that callback."""
    return frame.f_code.co_name == "_subscribe_to_clock_topic"


def _place(frame: FrameType) -> tuple[str, int]:
    """File and line at which a frame is, or the program's own that made it, as for rclpy's clock."""
    while frame.f_back is not None and not is_own(frame):
        frame = frame.f_back
    return frame.f_code.co_filename, frame.f_lineno


def _name_of(kind: str, made: Any) -> str:
    if kind == "subscription":
        return str(made.topic_name)
    if kind in ("service", "client"):
        return str(made.service_name)
    return ""


def _called(node: Any, kind: str, arguments: dict[str, Any]) -> str:
    """The name that a change uses: of the callback, or of a client's service."""
    name = written_at(arguments.get("callback"))[0]
    return str(node.resolve_service_name(arguments["srv_name"])) if kind == "client" else name
