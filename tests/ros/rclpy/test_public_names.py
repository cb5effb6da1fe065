"""Names and small habits of rclpy that programs rely on."""

import importlib
import subprocess
import sys

import pytest

import sim.ros.rclpy as rclpy
from sim.interfaces import message, rcl_interfaces, service
from sim.ros.context.context import Context
from sim.ros.context.signals import (
    SignalHandlerOptions,
    get_current_signal_handlers_options,
    install_signal_handlers,
)
from sim.ros.context.utilities import get_default_context
from sim.ros.entities.client import Client
from sim.ros.entities.event_handler import EventHandler
from sim.ros.entities.publisher import Publisher
from sim.ros.entities.service import Service
from sim.ros.entities.subscription import Subscription
from sim.ros.exceptions import InvalidHandle
from sim.ros.node.node import Node
from tests.support.simulation import Simulation, simulate

Int32 = message("std_msgs", "Int32")
SetBool = service("std_srvs", "SetBool")


def test_every_module_is_the_same_under_both_names() -> None:
    """What is imported as rclpy.… must not be loaded a second time, with classes of its own."""
    program = (
        "import importlib, pkgutil, warnings\n"
        "from sim.ros import importing\n"
        "importing.install()\n"
        "import rclpy\n"
        "warnings.simplefilter('ignore', DeprecationWarning)\n"
        "names = [found.name for found in pkgutil.walk_packages(rclpy.__path__, 'rclpy.')]\n"
        "names += [f'rclpy.{each}' for each in rclpy._namesakes.NAMESAKES | rclpy._namesakes.VALIDATORS]\n"
        "for name in names:\n"
        "    model = importlib.import_module(f'sim.ros.{name}')\n"
        "    assert importlib.import_module(name) is model, name\n"
        "    assert '._' not in name.replace('._rclpy_pybind11', '').replace('._namesakes', ''), name\n"
        "    print(name)\n"
    )
    found = subprocess.run([sys.executable, "-c", program], check=True, capture_output=True, text=True)
    assert {"rclpy.node", "rclpy.qos", "rclpy.client", "rclpy.action.client"} <= set(found.stdout.split())


def test_every_module_is_there_for_a_program_that_imports_the_package_only() -> None:
    program = (
        "from sim.ros import importing\n"
        "importing.install()\n"
        "import rclpy\n"
        "print(rclpy.executors.SingleThreadedExecutor, rclpy.time.Time, rclpy.logging.get_logger)\n"
        "print(rclpy.action.ActionClient)\n"
        "assert not hasattr(rclpy, 'scheduling')\n"
    )
    subprocess.run([sys.executable, "-c", program], check=True)


def test_messages_about_parameters_come_from_the_nodes_module_too() -> None:
    module = importlib.import_module("sim.ros.rclpy.node")
    assert module.SetParametersResult is rcl_interfaces.SetParametersResult
    assert module.HIDDEN_NODE_PREFIX == "_"


def test_messages_about_parameters_come_from_the_module_of_parameters_too() -> None:
    module = importlib.import_module("sim.ros.rclpy.parameter")
    assert module.ParameterType is rcl_interfaces.ParameterType
    assert module.ParameterMsg is rcl_interfaces.Parameter


def test_the_old_module_of_events_works_and_warns() -> None:
    sys.modules.pop("sim.ros.rclpy.qos_event", None)
    with pytest.warns(DeprecationWarning, match=r"use rclpy.event_handler instead"):
        module = importlib.import_module("sim.ros.rclpy.qos_event")
    assert module.QoSEventHandler is EventHandler


@pytest.mark.parametrize("generic", [Publisher, Subscription, Service, Client])
def test_classes_can_be_annotated_with_their_types(generic: type) -> None:
    assert generic[Int32].__origin__ is generic  # type: ignore[index]


def test_init_ends_its_context_after_a_with_block() -> None:
    def program(_: Simulation) -> None:
        rclpy.shutdown()
        with rclpy.init(args=[]) as begun:
            assert begun.context is get_default_context()
            assert rclpy.ok()
        assert not rclpy.ok()
        with rclpy.init(args=[]):
            assert rclpy.ok()
        own = Context()
        with pytest.raises(ValueError, match="broken"), rclpy.init(args=[], context=own):
            raise ValueError("broken")
        assert not own.ok()

    simulate(program, distro="kilted")


@pytest.mark.parametrize(
    ("is_default", "uninstall", "left"),
    [
        (True, None, SignalHandlerOptions.NO),
        (True, False, SignalHandlerOptions.ALL),
        (False, None, SignalHandlerOptions.ALL),
        (False, True, SignalHandlerOptions.NO),
    ],
)
def test_signals_are_handled_until_the_default_context_ends_or_as_told(
    is_default: bool, uninstall: bool | None, left: SignalHandlerOptions
) -> None:
    def program(_: Simulation) -> None:
        context = Context()
        context.init([])
        install_signal_handlers()
        rclpy.shutdown(context=None if is_default else context, uninstall_handlers=uninstall)
        assert get_current_signal_handlers_options() is left

    simulate(program)


def test_arguments_that_are_no_utf8_are_refused() -> None:
    def program(_: Simulation) -> None:
        with pytest.raises(UnicodeEncodeError):
            rclpy.init(context=Context(), args=["Ragnar\udcf6k"])

    simulate(program)


def test_a_destroyed_node_makes_nothing_that_has_a_name() -> None:
    def program(_: Simulation) -> None:
        node = Node("n")
        node.destroy_node()
        for make in (
            lambda: node.create_publisher(Int32, "t", 1),
            lambda: node.create_subscription(Int32, "t", lambda _: None, 1),
            lambda: node.create_service(SetBool, "s", lambda _, response: response),
            lambda: node.create_client(SetBool, "s"),
        ):
            with pytest.raises(InvalidHandle, match="destruction was requested"):
                make()

    simulate(program)


def test_a_call_that_is_given_up_is_no_longer_waited_for() -> None:
    def program(simulation: Simulation) -> None:
        client = Node("n").create_client(SetBool, "nobody")
        assert client.call(SetBool.Request(), timeout_sec=1.0) is None
        assert simulation.now == 1.0
        assert client._pending_requests == {}

    simulate(program)
