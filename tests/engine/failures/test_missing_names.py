"""What is said of names that packages of ROS 2 have, and the model has not."""

from pathlib import Path

import pytest

from sim.engine.failures.missing_names import _MISSING, on_missing_name
from tests.ros_packages.node_programs import printed
from tests.support.daily import first_row_daily
from tests.support.engine_runs import run_program

NAMES = [(module, name) for module, names, _ in _MISSING for name in names.split()]


@pytest.mark.parametrize(("module", "name"), NAMES)
def test_a_name_that_is_missing_is_told_by_what_does_its_work(module: str, name: str) -> None:
    said = on_missing_name(f"sim.ros_packages.{module}", name)
    assert said.startswith(f"{module}.{name} is not modelled here; ")
    assert len(said) < 170


def test_what_is_said_to_be_missing_is(tmp_path: Path) -> None:
    looks = "\n".join(
        f"assert not hasattr(importlib.import_module({module!r}), {name!r})"
        for module, name in NAMES
        if "." not in module
    )
    assert printed(tmp_path, f"import importlib\n{looks}\nprint('all missing')\n") == ["all missing"]


def test_a_name_of_ones_own_package_that_one_of_cbtuis_hides() -> None:
    assert (
        on_missing_name("sim", "SPEED") == "sim is a package of cbtui's own, which hides yours; rename yours"
    )


def test_other_names_are_left_to_spelling() -> None:
    assert on_missing_name("sim.ros_packages.tf2_ros", "Transformer") == ""


@pytest.mark.parametrize(
    ("line", "advice"),
    first_row_daily(
        ("Node('n', rosout_qos_profile=3)", "Kilted lets a node"),
        (
            "import rclpy.subscription_content_filter_options",
            "content filters came",
        ),
        (
            "node.create_subscription(String, 't', print, 1, content_filter_options=0)",
            "content filters came",
        ),
        ("node.create_subscription(String, 't', print, 1).is_cft_enabled", "content filters came"),
        (
            "ActionClient(node, Fibonacci, 'f').configure_introspection()",
            "introspection came with Kilted",
        ),
    ),
)
@pytest.mark.parametrize("distro", ["jazzy", "kilted"])
def test_what_only_kilted_has_is_told_in_a_sentence(
    tmp_path: Path, line: str, advice: str, distro: str
) -> None:
    head = (
        "import rclpy\nfrom rclpy.action import ActionClient\nfrom rclpy.node import Node\n"
        "from std_msgs.msg import String\nfrom example_interfaces.action import Fibonacci\nrclpy.init()\n"
        "node = Node('m')\n"
    )
    run = run_program(tmp_path, head + line, distro=distro)
    assert f"; {advice}" in run.ending.reason
