"""What a timeline says to wait in a queue is what waits there in the engine, whatever way messages go."""

from collections.abc import Callable
from functools import partial

import pytest

from sim.interfaces import message, service
from sim.ros.node.node import Node
from sim.ros.qos.qos import HistoryPolicy, QoSProfile
from sim.ros.scheduling.callback_groups import MutuallyExclusiveCallbackGroup
from sim.ros.scheduling.executors import SingleThreadedExecutor
from sim.ros.time.duration import Duration
from sim.trace import events as ev
from sim.trace.events import AnyEvent, EntityKind, GroupKind
from sim.trace.model import Queue, QueuedMessage
from sim.trace.timeline import Timeline
from tests.support.runs import ns
from tests.support.simulation import Simulation, simulate

Int32 = message("std_msgs", "Int32")
SetBool = service("std_srvs", "SetBool")

Program = Callable[[Simulation, Node], Callable[[], list[int]]]
"""Sets up a node with one callback that takes long; returns what tells the numbers that wait for it."""

LOOKS = [0.05 + 0.1 * place for place in range(80)]
"""Seconds, none of them one at which something happens."""


def sleeper(simulation: Simulation) -> Callable[..., None]:
    """A callback that takes 0.7 s."""
    return lambda *_: simulation.sleep(0.7)


def publish(simulation: Simulation, *each: tuple[float, QoSProfile]) -> None:
    """Publish from outside, for 5 s, with these periods."""
    for period, qos in each:
        publisher = simulation.outside_node(f"every_{round(period * 1000)}_ms").create_publisher(
            Int32, "/topic", qos
        )
        for count in range(round(5 / period)):
            simulation.at(count * period, partial(publisher.publish, Int32()))


def subscribed(depth: QoSProfile, *publishers: tuple[float, QoSProfile]) -> Program:
    def set_up(simulation: Simulation, node: Node) -> Callable[[], list[int]]:
        subscription = node.create_subscription(Int32, "/topic", sleeper(simulation), depth)
        publish(simulation, *publishers)
        return lambda: [each.message for each in subscription._queue]

    return set_up


def destroyed(simulation: Simulation, node: Node) -> Callable[[], list[int]]:
    subscription = node.create_subscription(Int32, "/topic", sleeper(simulation), 5)
    publish(simulation, (0.2, QoSProfile(depth=5)))
    simulation.at(3.0, lambda: node.destroy_subscription(subscription))
    return lambda: [each.message for each in subscription._queue] if simulation.now < 3.0 else []


def served(simulation: Simulation, node: Node) -> Callable[[], list[int]]:
    def answer(_: object, response: object) -> object:
        simulation.sleep(0.7)
        return response

    serving = node.create_service(SetBool, "/serve", answer)
    client = simulation.outside_node("client").create_client(SetBool, "/serve")
    for count in range(12):
        simulation.at(count * 0.2, lambda: client.call_async(SetBool.Request()))
    return lambda: [each.call for each in serving._queue]


def replied(simulation: Simulation, node: Node) -> Callable[[], list[int]]:
    server = simulation.outside_node("server")
    server.create_service(SetBool, "/serve", lambda _, response: response)
    simulation.spin_outside(server)
    group = MutuallyExclusiveCallbackGroup()
    client = node.create_client(SetBool, "/serve", callback_group=group)
    node.create_timer(1.0, sleeper(simulation), group)
    for count in range(12):
        simulation.at(count * 0.2, lambda: client.call_async(SetBool.Request()))
    return lambda: [each.call for each in client._queue]


KEEP_ALL = QoSProfile(history=HistoryPolicy.KEEP_ALL)
PLAIN = QoSProfile(depth=10)
SHORT_LIVED = QoSProfile(depth=10, lifespan=Duration(seconds=0.4))
PROGRAMS = {
    "a queue that overflows": subscribed(QoSProfile(depth=3), (0.1, PLAIN)),
    "keep all": subscribed(KEEP_ALL, (0.1, PLAIN)),
    "a lifespan": subscribed(KEEP_ALL, (0.1, SHORT_LIVED)),
    "a lifespan besides none": subscribed(QoSProfile(depth=6), (0.3, PLAIN), (0.2, SHORT_LIVED)),
    "destroyed": destroyed,
    "a service": served,
    "replies": replied,
}


@pytest.mark.parametrize("program", PROGRAMS.values(), ids=PROGRAMS.keys())
def test_the_messages_of_a_queue_are_those_that_wait_in_the_engine(program: Program) -> None:
    seen: list[list[int]] = []

    def run(simulation: Simulation) -> None:
        node = Node("n")
        look = program(simulation, node)
        for at in LOOKS:
            simulation.at(at, lambda: seen.append(look()))
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        executor.spin()

    trace = simulate(run, until=8.01)
    timeline = trace.timeline()
    (asked,) = (each.id for each in timeline.entities.values() if each.name in {"/topic", "/serve"})
    queues = [timeline.queue(asked, ns(at)) for at in LOOKS]
    assert [[each.id for each in queue.messages] for queue in queues] == seen
    assert [queue.depth for queue in queues] == [len(each) for each in seen]
    assert any(len(each) > 1 for each in seen)


def timeline_of(*events: AnyEvent) -> Timeline:
    timeline = Timeline()
    timeline.extend(events)
    return timeline


def appeared(entity: int, kind: EntityKind) -> list[AnyEvent]:
    return [
        ev.GroupAppeared(0, 1, 1, GroupKind.EXCLUSIVE, "Group"),
        ev.EntityAppeared(0, entity, 1, 1, kind, "/name", "callback", "", 0, 0, 2, 0),
    ]


DROP, READY = ev.MessageDropped(30, 1, 1, 1), ev.EntityReady(30, 1, 2, 3)
LATE_DROP, EARLY_READY = ev.MessageDropped(30, 1, 2, 1), ev.EntityReady(30, 1, 3, 3)


@pytest.mark.parametrize("events", [(DROP, READY), (EARLY_READY, LATE_DROP), (READY, LATE_DROP)])
def test_a_full_queue_may_tell_its_loss_before_or_after_the_arrival(events: tuple[AnyEvent, ...]) -> None:
    timeline = timeline_of(ev.EntityReady(10, 1, 1, 1), ev.EntityReady(20, 1, 2, 2), *events)
    assert timeline.queue(1, 29) == Queue(2, 0, [QueuedMessage(1, 10, 10), QueuedMessage(2, 20, 20)])
    assert timeline.queue(1, 30) == Queue(2, 1, [QueuedMessage(2, 20, 20), QueuedMessage(3, 30, 30)])


def test_a_message_is_as_old_as_its_publishing() -> None:
    timeline = timeline_of(
        *appeared(1, EntityKind.SUBSCRIPTION), ev.Published(5, 7, "/name", 0, 0), ev.EntityReady(9, 1, 1, 7)
    )
    (queued,) = timeline.moment(12).queues[1].messages
    assert queued.age(12) == 7
    assert timeline.queue(1, 12).oldest == 5


def test_a_request_is_as_old_as_its_sending_whatever_message_bears_its_number() -> None:
    timeline = timeline_of(
        *appeared(1, EntityKind.SERVICE),
        ev.Published(1, 7, "/elsewhere", 0, 0),
        ev.ServiceCalled(5, 7, "/name", 0, "request"),
        ev.EntityReady(9, 1, 1, 7),
    )
    assert timeline.queue(1, 12).messages == [QueuedMessage(7, 5, 9)]


def test_a_reply_is_as_old_as_its_arrival_whatever_message_bears_its_number() -> None:
    timeline = timeline_of(
        *appeared(1, EntityKind.CLIENT),
        ev.Published(1, 7, "/elsewhere", 0, 0),
        ev.ServiceCalled(5, 7, "/name", 0, "request"),
        ev.EntityReady(9, 1, 1, 7),
    )
    assert timeline.queue(1, 12).messages == [QueuedMessage(7, 9, 9)]


def test_who_takes_a_request_has_not_seen_the_scan_of_its_number() -> None:
    timeline = timeline_of(
        *appeared(1, EntityKind.SERVICE),
        ev.Scanned(1, 7, b"\x01\x00"),
        ev.CallbackStarted(3, 1, 1, 7, 0, 0),
        ev.CallbackStarted(4, 1, 1, 8, 0, 0),
        ev.Scanned(4, 8, b"\x01\x00"),
    )
    assert timeline.scan_seen(5) is None


def test_what_was_asked_before_more_came_stays_as_it_was() -> None:
    timeline = timeline_of(ev.EntityReady(10, 1, 1, 1), ev.EntityReady(30, 1, 2, 3))
    before = timeline.queue(1, 30)
    timeline.extend([ev.EntityReady(20, 1, 2, 2), ev.CallbackStarted(40, 1, 1, 1, 0, 2)])
    assert [each.id for each in before.messages] == [1, 3]
