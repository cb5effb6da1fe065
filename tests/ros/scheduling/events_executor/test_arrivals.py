"""An EventsExecutor's one queue in order of arrival, no group asked; as rclpy's C++ code has it."""

from typing import Any

import pytest

from sim.interfaces import service
from sim.ros.scheduling.callback_groups import CallbackGroup
from sim.trace.events import EntityGone, Reason, WaitStarted
from tests.ros.scheduling.events_executor.bench import Bench, Int32, numbers, on_bench

SetBool = service("std_srvs", "SetBool")


def test_messages_come_in_the_order_of_their_arrival_not_of_their_subscriptions() -> None:
    def program(bench: Bench) -> None:
        a, b = bench.hear("a"), bench.hear("b")
        bench.register()
        for each in numbers(2):
            b.publish(each)
            a.publish(each)
        bench.spin_for(1)

    assert on_bench(program)[0] == ["b0", "a0", "b1", "a1"]


def test_what_waits_when_a_node_is_added_is_one_event_a_subscription() -> None:
    def program(bench: Bench) -> None:
        a, b = bench.hear("a"), bench.hear("b")
        for each in numbers(2):
            b.publish(each)
            a.publish(each)
        bench.said.append(bench.spin_once())
        bench.said.append(bench.spin_once())

    assert on_bench(program)[0][2::3] == [["a0", "a1"], ["b0", "b1"]]


def test_a_newer_message_takes_the_place_of_the_dropped_one_and_leaves_its_own_empty() -> None:
    def program(bench: Bench) -> None:
        a, b = bench.hear("a", depth=1), bench.hear("b")
        bench.register()
        a.publish(Int32(data=0))
        b.publish(Int32(data=0))
        a.publish(Int32(data=1))
        bench.said.append([bench.spin_once() for _ in range(3)])

    assert on_bench(program)[0][-1] == [["a1"], ["b0"], []]


def test_no_group_is_asked() -> None:
    class Asked(CallbackGroup):
        def can_execute(self, entity: object) -> bool:
            return False

        beginning_execution = can_execute

        def ending_execution(self, entity: object) -> None:
            raise AssertionError

    def program(bench: Bench) -> None:
        bench.node.create_timer(1.0, lambda: bench.said.append("tick"), callback_group=Asked())
        bench.spin_for(1.5)

    assert on_bench(program)[0] == ["tick"]


def test_tasks_queue_in_order_among_the_rest() -> None:
    def program(bench: Bench) -> None:
        a = bench.hear("a")
        bench.register()
        bench.executor.create_task(bench.said.append, "first")
        a.publish(Int32(data=0))
        bench.executor.create_task(bench.said.append, "second")
        bench.said.append([bench.spin_once() for _ in range(3)])

    assert on_bench(program)[0][-1] == [["first"], ["a0"], ["second"]]


def test_what_is_queued_for_a_destroyed_subscription_is_still_heard() -> None:
    def program(bench: Bench) -> None:
        def heard(number: Any) -> None:
            bench.said.append(number.data)
            if number.data == 0:
                bench.node.destroy_subscription(subscription)

        subscription = bench.node.create_subscription(Int32, "a", heard, 10)
        publisher = bench.node.create_publisher(Int32, "a", 10)
        bench.register()
        for each in numbers(3):
            publisher.publish(each)
        bench.spin_for(1.0)
        publisher.publish(Int32(data=3))
        bench.spin_for(1.0)

    said, trace = on_bench(program)
    assert said == [0, 1, 2]
    assert len(trace.of(EntityGone)) == 1
    assert len(trace.ends("heard")) == 3
    trace.timeline()


def test_what_a_callback_destroys_gets_messages_until_the_queue_is_at_its_update() -> None:
    def program(bench: Bench) -> None:
        def first(number: Any) -> None:
            bench.said.append(("first", number.data))
            if number.data == 1:
                bench.node.destroy_subscription(second)
                bench.node.destroy_service(service)
                publisher.publish(Int32(data=2))
                client.call_async(SetBool.Request())
                bench.said.append((publisher.get_subscription_count(), client.service_is_ready()))

        bench.node.create_subscription(Int32, "a", first, 10)
        second = bench.node.create_subscription(
            Int32, "a", lambda number: bench.said.append(("second", number.data)), 1
        )
        service = bench.node.create_service(SetBool, "s", lambda _, response: bench.said.append("serves"))
        client = bench.node.create_client(SetBool, "s")
        publisher = bench.node.create_publisher(Int32, "a", 10)
        bench.register()
        publisher.publish(Int32(data=1))
        bench.spin_for(1.0)
        bench.said.append((publisher.get_subscription_count(), client.service_is_ready()))

    said, _ = on_bench(program)
    assert said == [("first", 1), (2, True), ("second", 2), ("first", 2), (1, False)]


def test_who_waits_does_so_behind_others_in_the_event_queue() -> None:
    def program(bench: Bench) -> None:
        a = bench.hear("a", lasts=1.0)
        bench.node.create_timer(0.5, lambda: None)
        bench.register()
        a.publish(Int32(data=0))
        bench.spin_for(1.2)

    trace = on_bench(program)[1]
    (wait, *_) = trace.of(WaitStarted)
    heard, timer = sorted(trace.names)
    assert (wait.t, wait.entity, wait.reason, wait.holder) == (500_000_000, timer, Reason.EVENT_QUEUE, heard)


@pytest.mark.parametrize("distro", ["jazzy@7.1.5", "kilted@9.1.2"])
def test_a_reply_reaches_the_clients_of_its_service_in_the_order_of_their_making(distro: str) -> None:
    # Measured on both: what awaits is asked behind the older client, which takes nothing.
    def program(bench: Bench) -> None:
        bench.node.create_service(SetBool, "s", lambda _, response: response)
        older, newer = (bench.node.create_client(SetBool, "s") for _ in range(2))
        bench.register()

        async def wait() -> None:
            for _ in range(2):
                newer.call_async(SetBool.Request()).add_done_callback(lambda _: bench.said.append("got"))
            await older.call_async(SetBool.Request())
            bench.said.append("goes on")

        bench.executor.create_task(wait)
        bench.spin_for(0.5)

    assert on_bench(program, distro=distro)[0] == ["got", "goes on", "got"]
