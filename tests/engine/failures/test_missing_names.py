"""What is said of names that packages of ROS 2 have, and the model has not."""

from pathlib import Path

import pytest

from sim.engine.failures.missing_names import _MISSING, on_missing_name
from tests.ros_packages.node_programs import printed

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


def test_other_names_are_left_to_spelling() -> None:
    assert on_missing_name("sim.ros_packages.tf2_ros", "Transformer") == ""
