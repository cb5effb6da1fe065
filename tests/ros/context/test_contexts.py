"""Contexts: domains, what happens when one ends, and the signals that end it."""

import gc
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest

import sim.ros.rclpy as rclpy
from sim.interfaces import message, service
from sim.ros.context.context import Context
from sim.ros.context.signals import (
    SignalHandlerOptions,
    deliver_sigint,
    deliver_sigterm,
    get_current_signal_handlers_options,
    install_signal_handlers,
    uninstall_signal_handlers,
)
from sim.ros.exceptions import RCLError, ROSInterruptException
from sim.ros.middleware import host as hosts
from sim.ros.middleware.process import Process, current_process
from sim.ros.node.node import Node
from sim.ros.rclpy._entities.wait_for_message import wait_for_message
from sim.ros.scheduling.events_executor import EventsExecutor
from sim.ros.scheduling.executors import (
    ExternalShutdownException,
    MultiThreadedExecutor,
    SingleThreadedExecutor,
)
from sim.ros.time.duration import Duration
from tests.support.simulation import Simulation, simulate

Int32 = message("std_msgs", "Int32")
SetBool = service("std_srvs", "SetBool")


def in_domain(domain: int) -> Context:
    context = Context()
    context.init([], domain_id=domain)
    return context


# Domains


def test_nodes_of_different_domains_do_not_see_each_other() -> None:
    def program(_: Simulation) -> None:
        here, there = Node("here"), Node("there", context=in_domain(7))
        heard: list[object] = []
        here.create_subscription(Int32, "t", heard.append, 10)
        publisher = there.create_publisher(Int32, "t", 10)
        publisher.publish(Int32())
        rclpy.spin_once(here, timeout_sec=0.0)
        assert not heard
        assert publisher.get_subscription_count() == 0
        assert here.get_node_names() == ["here"]
        assert there.get_node_names() == ["there"]
        assert here.count_publishers("t") == 0
        assert Node("too", context=in_domain(7)).get_node_names() == ["there", "too"]

    simulate(program)


def test_a_service_answers_within_its_domain() -> None:
    empty = service("std_srvs", "Empty")

    def program(_: Simulation) -> None:
        Node("server", context=in_domain(1)).create_service(empty, "s", lambda _, response: response)
        assert not Node("client").create_client(empty, "s").service_is_ready()
        assert Node("near", context=in_domain(1)).create_client(empty, "s").service_is_ready()

    simulate(program)


def test_the_domain_is_the_one_asked_for_or_the_environment_s(monkeypatch: pytest.MonkeyPatch) -> None:
    def program(simulation: Simulation) -> None:
        context = Context()
        with pytest.raises(RuntimeError, match="must be initialized before it can have a domain id"):
            context.get_domain_id()
        monkeypatch.setenv("ROS_DOMAIN_ID", "23")
        context.init([])
        assert context.get_domain_id() == 23
        assert in_domain(3).get_domain_id() == 3
        monkeypatch.setenv("ROS_DOMAIN_ID", "x")
        with pytest.raises(RCLError, match="ROS_DOMAIN_ID is not an integral number: 'x'"):
            Context().init([])
        with pytest.raises(RuntimeError, match=r"Domain id \(-1\) should not be lower than zero"):
            Context().init([], domain_id=-1)
        told: list[int] = []

        def own_environment() -> None:
            context = Context()
            context.init([])
            told.append(context.get_domain_id())

        process = Process(simulation.host, environment={"ROS_DOMAIN_ID": "5"})
        process.start_thread(own_environment, "MainThread")
        simulation.sleep(0.1)
        assert told == [5]

    simulate(program)


# The end of a context


def test_callbacks_are_called_when_it_is_shut_down_in_their_order() -> None:
    def program(_: Simulation) -> None:
        context, told = in_domain(0), []
        for number in range(3):
            context.on_shutdown(lambda number=number: told.append(number))  # type: ignore[misc]
        context.shutdown()
        assert told == [0, 1, 2]
        context.on_shutdown(lambda: told.append(3))
        assert told[3:] == [3]
        with pytest.raises(RCLError, match="rcl_shutdown already called on the given context"):
            context.shutdown()
        context.try_shutdown()
        with pytest.raises(RuntimeError, match="must be initialized before it can be shutdown"):
            Context().shutdown()

    simulate(program)


def test_bound_methods_are_held_weakly() -> None:
    class Owner:
        def tell(self) -> None:
            pytest.fail("nobody holds this any more")

    def program(_: Simulation) -> None:
        context = in_domain(0)
        owner = Owner()
        context.on_shutdown(owner.tell)
        del owner
        gc.collect()
        context.shutdown()

    simulate(program)


def test_waiting_for_a_message_leaves_nothing_behind() -> None:
    def program(_: Simulation) -> None:
        node = Node("n")
        before = len(node.context._end_callbacks)
        assert wait_for_message(Int32, node, "t", time_to_wait=0.1) == (False, None)
        gc.collect()
        assert len(node.context._end_callbacks) == before

    simulate(program)


def test_nothing_is_made_or_asked_in_a_context_that_has_ended() -> None:
    def program(_: Simulation) -> None:
        node = Node("n")
        client = node.create_client(SetBool, "s")
        node.context.shutdown()
        of_context, of_node = "the given context is not valid", "rcl node's context is invalid"
        for refused, why in (
            (lambda: node.create_timer(1.0, print), of_context),
            (lambda: node.create_rate(1.0), of_context),
            (lambda: node.create_guard_condition(print), of_context),
            (lambda: SingleThreadedExecutor(context=node.context), of_context),
            (lambda: MultiThreadedExecutor(2, context=node.context), of_context),
            (lambda: node.create_publisher(Int32, "t", 1), of_node),
            (lambda: node.create_subscription(Int32, "t", print, 1), of_node),
            (lambda: node.create_service(SetBool, "s", print), of_node),
            (lambda: node.create_client(SetBool, "s"), of_node),
            (client.service_is_ready, of_node),
            (node.get_node_names, of_node),
            (node.get_topic_names_and_types, of_node),
            (lambda: node.count_publishers("t"), of_node),
            (lambda: node.declare_parameter("p", 1), "publisher's context is invalid"),
        ):
            with pytest.raises(RCLError, match=why):
                refused()

    simulate(program)


# Signals in an engine


def test_sigint_ends_every_context_of_its_process_and_of_no_other() -> None:
    ended = []

    def program(simulation: Simulation) -> None:
        def other() -> None:
            rclpy.init(args=[])
            try:
                rclpy.spin(Node("other"))
            except ExternalShutdownException:
                ended.append(simulation.now)
            assert not rclpy.ok()
            rclpy.try_shutdown()
            rclpy.init(args=[])
            assert rclpy.ok()

        process = Process(simulation.host)
        process.start_thread(other, "MainThread")
        second, pool = in_domain(0), MultiThreadedExecutor(2)
        simulation.at(1.0, lambda: ended.append(deliver_sigint(process)))
        simulation.sleep(2.0)
        assert ended == [True, 1.0]
        assert rclpy.ok()
        assert second.ok()
        simulation.at(3.0, lambda: deliver_sigint(current_process()))
        pool.add_node(Node("n"))
        pool.spin()
        assert simulation.now == 3.0
        assert not second.ok()

    simulate(program)


def test_a_process_that_wants_no_signals_goes_on() -> None:
    def program(simulation: Simulation) -> None:
        uninstall_signal_handlers()
        assert not deliver_sigint(current_process())
        install_signal_handlers(SignalHandlerOptions.SIGTERM)
        assert not deliver_sigint(current_process())
        assert rclpy.ok()
        second = in_domain(0)
        install_signal_handlers(SignalHandlerOptions.SIGINT)
        assert deliver_sigint(current_process())
        assert not rclpy.ok()
        assert not second.ok()
        third = in_domain(0)
        assert deliver_sigterm(current_process())
        assert not third.ok()

    simulate(program)


def test_a_signal_calls_no_shutdown_callbacks_and_wakes_what_waits() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.context.on_shutdown(lambda: pytest.fail("it was not shut down"))
        simulation.at(1.0, lambda: deliver_sigint(node.context.process))
        assert not node.get_clock().sleep_for(Duration(seconds=5))
        assert simulation.now == 1.0
        with pytest.raises(RCLError):
            rclpy.shutdown()

    simulate(program)


def test_signals_add_up_and_must_be_some() -> None:
    def program(_: Simulation) -> None:
        assert get_current_signal_handlers_options() == SignalHandlerOptions.ALL
        rclpy.init(args=[], context=Context())
        assert get_current_signal_handlers_options() == SignalHandlerOptions.ALL
        uninstall_signal_handlers()
        rclpy.init(args=[], context=Context(), signal_handler_options=SignalHandlerOptions.SIGTERM)
        assert get_current_signal_handlers_options() == SignalHandlerOptions.SIGTERM
        install_signal_handlers(SignalHandlerOptions.SIGINT)
        assert get_current_signal_handlers_options() == SignalHandlerOptions.ALL
        with pytest.raises(TypeError):
            rclpy.init(args=[], context=Context(), signal_handler_options=7)  # type: ignore[arg-type]

    simulate(program)


# Signals in a program of its own


@pytest.fixture
def plain_library() -> Iterator[None]:
    """The model as a plain library: no host of an engine, and no handler left after."""
    before = hosts._host
    hosts._host = None
    handler = signal.getsignal(signal.SIGINT)
    yield
    assert signal.getsignal(signal.SIGINT) is handler
    hosts._host = before


@pytest.mark.usefixtures("plain_library")
def test_handlers_are_there_from_init_to_shutdown() -> None:
    before = signal.getsignal(signal.SIGINT), signal.getsignal(signal.SIGTERM)
    rclpy.init(args=[])
    assert before != (signal.getsignal(signal.SIGINT), signal.getsignal(signal.SIGTERM))
    rclpy.shutdown()
    assert before == (signal.getsignal(signal.SIGINT), signal.getsignal(signal.SIGTERM))


@pytest.mark.usefixtures("plain_library")
@pytest.mark.parametrize(
    ("number", "error"),
    [(signal.SIGINT, KeyboardInterrupt), (signal.SIGTERM, ExternalShutdownException)],
)
def test_a_signal_ends_the_contexts(number: signal.Signals, error: type[BaseException]) -> None:
    rclpy.init(args=[])
    executor = SingleThreadedExecutor()
    executor.add_node(Node("n"))

    def kill() -> None:
        while not executor._waiting:
            time.sleep(0.001)
        os.kill(os.getpid(), number)

    killer = threading.Thread(target=kill)
    killer.start()
    with pytest.raises(error):
        executor.spin()
    killer.join()
    assert not rclpy.ok()
    rclpy.try_shutdown()


def spin_until_signal(executor: Any) -> None:
    ended_by_test: list[bool] = []

    def end() -> None:
        ended_by_test.append(True)
        executor.shutdown()

    late = threading.Timer(10.0, end)
    late.start()
    with pytest.raises(ExternalShutdownException):
        executor.spin()
    late.cancel()
    assert not ended_by_test


@pytest.mark.usefixtures("plain_library")
def test_a_signal_between_the_last_look_and_the_wait_ends_that(monkeypatch: pytest.MonkeyPatch) -> None:
    rclpy.init(args=[])
    executor = SingleThreadedExecutor()
    executor.add_node(Node("n"))
    look = executor._raise_if_over

    def look_and_kill(condition: Callable[[], bool]) -> None:
        look(condition)
        os.kill(os.getpid(), signal.SIGTERM)

    monkeypatch.setattr(executor, "_raise_if_over", look_and_kill)
    spin_until_signal(executor)
    rclpy.try_shutdown()


@pytest.mark.usefixtures("plain_library")
def test_a_signal_before_an_events_executor_waits_ends_that(monkeypatch: pytest.MonkeyPatch) -> None:
    rclpy.init(args=[])
    executor = EventsExecutor()
    executor.add_node(Node("n"))
    due = executor._queue._next_appointment

    def due_and_kill() -> int | None:
        if sys._getframe(1).f_code.co_name == "next":  # which has looked whether the queue is stopped
            signal.raise_signal(signal.SIGTERM)
        return due()

    monkeypatch.setattr(executor._queue, "_next_appointment", due_and_kill)
    spin_until_signal(executor)
    rclpy.try_shutdown()


@pytest.mark.usefixtures("plain_library")
def test_a_signal_before_a_rate_sleeps_ends_that() -> None:
    class Killing(list[Any]):
        def append(self, sleeper: Any) -> None:
            signal.raise_signal(signal.SIGTERM)
            super().append(sleeper)

    rclpy.init(args=[])
    rate = Node("n").create_rate(1.0)
    rate._sleepers = Killing()
    with pytest.raises(ROSInterruptException):
        rate.sleep()
    rclpy.try_shutdown()


@pytest.mark.usefixtures("plain_library")
def test_a_handler_that_a_program_put_in_place_stays() -> None:
    before = signal.getsignal(signal.SIGINT)

    def own(*_: object) -> None:
        """Do nothing."""

    rclpy.init(args=[])
    signal.signal(signal.SIGINT, own)
    rclpy.shutdown()
    assert signal.getsignal(signal.SIGINT) is own
    signal.signal(signal.SIGINT, before)


def test_ctrl_c_wakes_a_program_that_waits() -> None:
    program = """
import os, signal, threading
from sim.ros import importing
importing.install()
import rclpy
rclpy.init()
node = rclpy.create_node("n")
threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT)).start()
try:
    rclpy.spin(node)
except KeyboardInterrupt:
    print("interrupted", rclpy.ok())
node.destroy_node()
rclpy.try_shutdown()
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert (done.stdout, done.stderr) == ("interrupted False\n", "")
