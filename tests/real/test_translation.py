"""What probes send becomes the trace: in order, in the run's time, with messages and calls linked."""

import math

import msgspec
import pytest

from sim.real.translation import Translation
from sim.real.wire import Called, MessageTaken, Sent, decode_lines, finite
from sim.trace.events import (
    AnyEvent,
    CallbackEnded,
    CallbackResumed,
    CallbackStarted,
    CallbackSuspended,
    CallBlocked,
    CallUnblocked,
    EntityAppeared,
    EntityGone,
    EntityKind,
    EntityReady,
    EventsLost,
    Logged,
    MessageDropped,
    NodeAppeared,
    Notice,
    ProcessEnded,
    Published,
    Reason,
    RobotMoved,
    ServiceCalled,
    ServiceReplied,
    Severity,
    ThreadAppeared,
    WaitEnded,
    WaitStarted,
)

START = 5_000
NODE, HEARD, SERVED, CLIENT, THREAD = 71, 72, 73, 74, 75


class Told:
    """A translation, and the events that it told."""

    def __init__(self) -> None:
        self.events: list[AnyEvent] = []
        self.began: list[int] = []
        self.translation = Translation(self.events.append, self.began.append)
        self.tell(NodeAppeared(START, NODE, "/n"))
        self.tell(appeared(HEARD, EntityKind.SUBSCRIPTION, "/news", depth=2))
        self.tell(appeared(SERVED, EntityKind.SERVICE, "/switch", depth=10))
        self.tell(appeared(CLIENT, EntityKind.CLIENT, "/switch", depth=10))
        self.tell(ThreadAppeared(START, THREAD, "MainThread"))

    def tell(self, *lines: object, process: int = 0) -> None:
        self.translation.take(lines, process)  # type: ignore[arg-type]

    def all(self, kind: type[AnyEvent]) -> list[AnyEvent]:
        self.translation.release(10**18)
        return [event for event in self.events if isinstance(event, kind)]


def appeared(entity: int, kind: EntityKind, name: str, depth: int) -> EntityAppeared:
    return EntityAppeared(START, entity, NODE, 1, kind, name, "", "", 0, 0, depth, 0)


def sent(t: int, wall: int) -> Sent:
    return Sent(t, 1000 + t, "/news", NODE, 0, wall, wall + 5)


def test_the_run_begins_with_the_first_node_whoever_tells_of_it() -> None:
    told = Told()
    told.tell(Notice(START - 900, Severity.INFO, "before"))
    told.tell(NodeAppeared(START + 400, 90, "/later"))
    told.tell(NodeAppeared(START - 300, 91, "/of_a_process_that_answers_later"), process=2)
    assert [event.t for event in told.all(NodeAppeared)] == [0, 300, 700]
    assert told.began == [START - 300]
    assert [event.t for event in told.all(Notice)] == [0]


def test_events_of_several_threads_and_processes_come_in_order() -> None:
    told = Told()
    told.tell(Notice(START + 300, Severity.INFO, "c"), Notice(START + 200, Severity.INFO, "b"))
    told.tell(Notice(START + 100, Severity.INFO, "a"), process=2)
    told.translation.release(START + 250)
    assert [event.text for event in told.events if isinstance(event, Notice)] == ["a", "b"]
    assert [getattr(event, "text", None) for event in told.all(Notice)] == ["a", "b", "c"]


def test_threads_belong_to_their_process() -> None:
    told = Told()
    told.tell(ThreadAppeared(START, 99, "MainThread"), process=3)
    assert [getattr(event, "process", None) for event in told.all(ThreadAppeared)] == [0, 3]


def test_a_callback_that_went_on_on_another_thread_is_closed_there_once() -> None:
    told = Told()
    told.tell(appeared(90, EntityKind.TIMER, "", depth=0), process=2)
    told.tell(CallbackStarted(START + 10, 90, THREAD, 0, 0, 0), CallbackSuspended(START + 11, 90, THREAD))
    told.tell(CallbackResumed(START + 12, 90, 76), ProcessEnded(START + 20, 2, "it was killed", 1))
    assert told.all(CallbackEnded) == [CallbackEnded(20, 90, 76)]


def test_what_a_killed_process_was_at_is_over_with_it_and_others_go_on() -> None:
    told = Told()
    for process, at in ((1, 80), (2, 90)):
        told.tell(
            appeared(at, EntityKind.TIMER, "", depth=0),
            appeared(at + 1, EntityKind.TIMER, "", depth=0),
            CallbackStarted(START + 10, at, at + 5, 0, 0, 0),
            CallBlocked(START + 20, 0, at + 5, at, "/switch"),
            WaitStarted(START + 20, at + 1, START + 20, Reason.GROUP_HELD, at, False),
            process=process,
        )
    told.tell(ProcessEnded(START + 50, 2, "it was killed", 1))
    told.translation.release(10**18)
    closing = [event for event in told.events if event.t == 50]
    assert closing[:2] == [CallUnblocked(50, 0, 95), CallbackEnded(50, 90, 95)]
    assert {event.entity for event in closing if isinstance(event, EntityGone)} == {90, 91}
    assert closing[-1] == ProcessEnded(50, 2, "it was killed", 1)
    assert len(closing) == 5


def test_a_message_is_the_one_that_was_sent_at_that_time() -> None:
    told = Told()
    told.tell(sent(START + 10, 500), sent(START + 20, 600))
    told.tell(
        MessageTaken(START + 30, HEARD, THREAD, 503, 40), MessageTaken(START + 40, HEARD, THREAD, 602, 50)
    )
    first, second = told.all(Published)
    assert isinstance(first, Published)
    assert isinstance(second, Published)
    starts = [event for event in told.all(CallbackStarted) if isinstance(event, CallbackStarted)]
    assert [(each.message, each.age) for each in starts] == [(first.message, 40), (second.message, 50)]
    assert first.message < second.message


def test_a_message_from_elsewhere_has_no_number() -> None:
    told = Told()
    told.tell(sent(START + 10, 500), MessageTaken(START + 30, HEARD, THREAD, 700, 40))
    [start] = told.all(CallbackStarted)
    assert isinstance(start, CallbackStarted)
    assert start.message == 0


def test_what_waits_has_its_messages_in_its_queue_and_a_full_one_loses_the_oldest() -> None:
    told = Told()
    told.tell(sent(START + 10, 500))
    told.tell(EntityReady(START + 20, HEARD, 1, 0))
    told.tell(WaitStarted(START + 20, HEARD, START + 15, Reason.GROUP_HELD, 0, False))
    told.tell(sent(START + 30, 600), sent(START + 40, 700))
    told.tell(WaitEnded(START + 50, HEARD), MessageTaken(START + 50, HEARD, THREAD, 601, 9))
    depths = [(e.depth, e.message) for e in told.all(EntityReady) if isinstance(e, EntityReady)]
    assert depths == [(1, 1), (2, 2), (2, 3)]
    [lost] = told.all(MessageDropped)
    assert isinstance(lost, MessageDropped)
    assert (lost.t, lost.message, lost.depth) == (40, 1, 1)
    [start] = told.all(CallbackStarted)
    assert isinstance(start, CallbackStarted)
    assert (start.message, start.depth) == (2, 1)
    [wait] = told.all(WaitStarted)
    assert isinstance(wait, WaitStarted)
    assert (wait.t, wait.since) == (20, 15)


def test_what_a_subscription_passes_over_is_lost() -> None:
    told = Told()
    told.tell(sent(START + 10, 500), MessageTaken(START + 15, HEARD, THREAD, 502, 9))
    told.tell(sent(START + 20, 600), sent(START + 25, 700), sent(START + 30, 800))
    told.tell(MessageTaken(START + 40, HEARD, THREAD, 802, 9))
    assert [getattr(event, "message", None) for event in told.all(MessageDropped)] == [2, 3]


def test_what_comes_of_a_publisher_that_was_never_heard_is_not_lost() -> None:
    def robot(t: int) -> Sent:
        return Sent(START + t, t, "/news", 0, 0, 10 * t, 10 * t + 5)

    told = Told()
    told.tell(sent(START + 10, 100), MessageTaken(START + 15, HEARD, THREAD, 101, 0))
    told.tell(robot(20), robot(30), robot(40))
    told.tell(EntityReady(START + 50, HEARD, 1, 0))
    told.tell(robot(60), sent(START + 70, 700), robot(80))
    told.tell(MessageTaken(START + 90, HEARD, THREAD, 701, 0))
    assert told.all(MessageDropped) == []
    assert [event.message for event in told.all(EntityReady) if isinstance(event, EntityReady)] == [0, 6]


def test_what_was_sent_before_a_publisher_was_heard_first_is_not_lost() -> None:
    told = Told()
    told.tell(sent(START + 10, 500), sent(START + 20, 600), MessageTaken(START + 40, HEARD, THREAD, 602, 9))
    assert not told.all(MessageDropped)


def test_what_was_taken_before_its_sending_was_told_of_is_not_lost() -> None:
    told = Told()
    told.tell(sent(START + 10, 500), MessageTaken(START + 15, HEARD, THREAD, 502, 9))
    told.tell(MessageTaken(START + 25, HEARD, THREAD, 602, 9))
    assert told.all(MessageDropped) == []
    told.tell(sent(START + 20, 600), sent(START + 30, 700), MessageTaken(START + 40, HEARD, THREAD, 702, 9))
    assert told.all(MessageDropped) == []


def test_a_call_keeps_its_number_from_request_to_reply() -> None:
    told = Told()
    told.tell(Called(START + 10, 4711, "/switch", 0, "request", 500, 505))
    told.tell(MessageTaken(START + 20, SERVED, THREAD, 502, 9))
    told.tell(ServiceReplied(START + 30, 4711, "/switch", "well"))
    told.tell(CallbackStarted(START + 31, CLIENT, THREAD, 4711, 0, 0))
    [call] = told.all(ServiceCalled)
    [reply] = told.all(ServiceReplied)
    served, taken = told.all(CallbackStarted)
    numbers = {getattr(each, "call", None) for each in (call, reply)}
    assert numbers == {getattr(each, "message", None) for each in (served, taken)} == {1}


def test_a_reply_that_waits_is_that_of_the_oldest_open_call() -> None:
    told = Told()
    told.tell(Called(START + 10, 4711, "/switch", 0, "request", 500, 505))
    told.tell(EntityReady(START + 20, CLIENT, 1, 0))
    [ready] = told.all(EntityReady)
    assert isinstance(ready, EntityReady)
    assert (ready.entity, ready.message) == (CLIENT, 1)


def test_losses_of_all_processes_are_added_up() -> None:
    told = Told()
    told.tell(EventsLost(START + 1, 5), process=1)
    told.tell(EventsLost(START + 2, 7), process=2)
    told.tell(EventsLost(START + 3, 6), process=1)
    assert [getattr(event, "count", None) for event in told.all(EventsLost)] == [5, 12, 13]


def test_a_robot_with_nothing_in_sight_comes_through_json() -> None:
    told = Told()
    moved = RobotMoved(START, 0.0, 0.0, 0.0, math.inf, 0.0, 0.0, True, False, 0.0, 0.0)
    told.tell(*decode_lines(msgspec.json.encode([finite(moved)]) + b"\n"))
    [shown] = told.all(RobotMoved)
    assert isinstance(shown, RobotMoved)
    assert shown.front == math.inf


@pytest.mark.parametrize("data", [b"no json\n", b'[["no such event",1]]\n', b'[["taken","x"]]\n', b"\xff\n"])
def test_what_no_probe_sends_is_told_apart(data: bytes) -> None:
    with pytest.raises(msgspec.DecodeError):
        decode_lines(data)


def test_log_lines_are_events_as_they_are() -> None:
    [line] = decode_lines(b'[["log",7,"WARN","n","text",75,72]]\n')
    assert line == Logged(7, Severity.WARN, "n", "text", 75, 72)


def test_calls_that_nobody_answers_are_forgotten_in_the_end() -> None:
    told = Told()
    for number in range(3_000):
        told.tell(Called(START + 10 + number, 10_000 + number, "/switch", 0, "request", number, number))
    told.tell(EntityReady(START + 5_000, CLIENT, 1, 0))
    ready = told.all(EntityReady)[-1]
    assert isinstance(ready, EntityReady)
    assert ready.message == 1_001
