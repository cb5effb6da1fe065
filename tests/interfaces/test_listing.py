"""Interfaces as the ros2 interface commands show them."""

from __future__ import annotations

from itertools import product

import pytest

from sim.interfaces import UnknownInterfaceError, interface_text, kinds_sentence, names, packages
from sim.interfaces.interface_definition import Kind


def test_messages_in_a_message_are_shown_below_it_by_tabs() -> None:
    assert interface_text("geometry_msgs/msg/Twist") == (
        "# This expresses velocity in free space broken into its linear and angular parts.\n\n"
        "Vector3  linear\n\tfloat64 x\n\tfloat64 y\n\tfloat64 z\n"
        "Vector3  angular\n\tfloat64 x\n\tfloat64 y\n\tfloat64 z\n"
    )
    assert "std_msgs/Header header\n\tbuiltin_interfaces/Time stamp\n\t\tint32 sec\n" in interface_text(
        "geometry_msgs/msg/PoseStamped"
    )


def test_services_and_actions_keep_their_division() -> None:
    assert interface_text("std_srvs/srv/SetBool") == "bool data\n---\nbool success\nstring message\n"
    assert interface_text("example_interfaces/action/Fibonacci").count("---\n") == 2


def test_every_interface_can_be_shown() -> None:
    kinds: tuple[Kind, ...] = ("msg", "srv", "action")
    for package, kind in product(packages(), kinds):
        for name in names(package, kind):
            text = interface_text(f"{package}/{kind}/{name}")
            assert text == "" or text.endswith("\n")


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("std_msgs/Int32", "Invalid name 'std_msgs/Int32'. Expected three parts"),
        ("std_msgs/foo/Int32", "middle part must be one of msg, srv, action"),
        ("std_mgs/msg/Int32", "there is no package 'std_mgs'; did you mean 'std_msgs'?"),
    ],
)
def test_a_wrong_name_says_what_is_wrong(name: str, text: str) -> None:
    with pytest.raises(UnknownInterfaceError) as unknown:
        interface_text(name)
    assert text in str(unknown.value)


def test_a_package_tells_what_kinds_of_interfaces_it_has() -> None:
    assert kinds_sentence("std_srvs") == "std_srvs has services only"
    assert kinds_sentence("nav_msgs") == "nav_msgs has messages and services only"
