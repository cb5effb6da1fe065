"""What each release of rclpy does differently, on the model and on the wheels that there are."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from cbtui.commands.options.changes import release_of
from sim.real.programs import claimed_domain, unbootstrapped
from sim.releases.distros import DISTROS, UnknownProfileError
from sim.releases.profile import Profile
from sim.trace.events import Notice, Printed, RunStarted
from tests.real.programs import needs_ros
from tests.ros.profiles.programs import DIFFERING, Differing
from tests.support.engine_runs import run_program

_BEHAVIOURS = [name for name, each in vars(Profile).items() if isinstance(each, property)]
_WHEELS = os.environ.get("CBTUI_ROS_PYTHONS", sys.executable).split(os.pathsep)
"""Pythons with ROS 2."""


@pytest.mark.parametrize(
    ("each", "distro"),
    [
        pytest.param(each, distro, id=f"{each.behaviour}-{distro}")
        for each in DIFFERING
        for distro in each.said
    ],
)
def test_the_model_does_what_the_release_does(each: Differing, distro: str, tmp_path: Path) -> None:
    run = run_program(tmp_path, each.source, distro=distro)
    assert ", ".join(event.text for event in run.events if isinstance(event, Printed)) == each.said[distro]


@needs_ros
@pytest.mark.slow
@pytest.mark.parametrize("python", _WHEELS)
def test_the_wheels_do_what_the_release_does(python: str, tmp_path: Path) -> None:
    release = release_of(python)
    assert release is not None
    programs = []
    domain, claim = claimed_domain()
    with claim:
        environment = {**unbootstrapped(python), "ROS_DOMAIN_ID": str(domain)}
        for place, each in enumerate(DIFFERING):
            file = tmp_path / f"{place}.py"
            file.write_text(each.source)
            ran = subprocess.run([python, file], check=False, capture_output=True, text=True, env=environment)
            programs.append((each.behaviour, ", ".join(ran.stdout.splitlines())))
    assert programs == [(each.behaviour, each.said[release]) for each in DIFFERING]


def test_every_behaviour_names_its_source_and_has_a_program() -> None:
    texts = {name: getattr(Profile, name).__doc__ for name in _BEHAVIOURS}
    assert [name for name, text in texts.items() if "Source: " not in text] == []
    shown = {each.behaviour for each in DIFFERING}
    assert set(_BEHAVIOURS) - shown == {"call_raises_timeout"}, "that one is seen with call_takes_timeout"


def test_a_release_is_named_with_or_without_its_patch() -> None:
    assert str(Profile.named("jazzy")) == str(Profile())
    assert str(Profile.named("jazzy@7.1.6")) == "jazzy@7.1.6"
    assert {str(Profile.named(each)) for each in DISTROS} == {
        "humble@3.3.22",
        "jazzy@7.1.12",
        "kilted@9.1.2",
        "lyrical",
    }


@pytest.mark.parametrize(
    "name", ["", "foxy", "jazzy@", "jazzy@9.1.2", "jazzy@7.1", "lyrical@10.0.1", "jazzy@7.1.x"]
)
def test_what_is_no_release_is_refused(name: str) -> None:
    with pytest.raises(UnknownProfileError):
        Profile.named(name)


def test_a_file_may_choose_its_release_and_the_trace_tells_it(tmp_path: Path) -> None:
    run = run_program(tmp_path, "# cbtui: distro = kilted\n")
    assert [each.distro for each in run.events if isinstance(each, RunStarted)] == ["kilted@9.1.2"]


def test_a_release_that_a_file_cannot_have_is_told(tmp_path: Path) -> None:
    run = run_program(tmp_path, "# cbtui: distro = foxy\n")
    (said,) = [each.text for each in run.events if isinstance(each, Notice)]
    assert "'foxy' is no distribution" in said
    assert said.endswith(f"the run is like {Profile()}")
