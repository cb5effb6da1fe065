"""The mark, the options and the fixture; pytest always loads this, and the rest of cbtui only for a test."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from cbtui.pytest_plugin.runner import Runner

_MARK = (
    "cbtui(seconds=10, calls=(), lines=(), arguments=(), threads=None, groups={}, periods={}, "
    "sensor_rate=None, distro=None, schedules=1, seed=None, on='model', python=None, robot=True, limit=60): "
    "how the fixture cbtui runs programs"
)

_OWN_PACKAGES = {"cbtui", "lessons", "sim"}


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the options, which all begin with ``--cbtui-``."""
    group = parser.getgroup("cbtui", "ROS 2 nodes on virtual time")
    group.addoption(
        "--cbtui-on", choices=("model", "ros2"), help="run on this whatever tests ask for: model or ros2"
    )
    group.addoption(
        "--cbtui-seed",
        metavar="S",
        help="run in this order of threads alone, as a failure or cbtui explore names it",
    )
    parser.addini(
        "cbtui_recordings", "folder for the recordings of runs that failed a test", default="cbtui-recordings"
    )


def pytest_configure(config: pytest.Config) -> None:
    """Describe the mark."""
    config.addinivalue_line("markers", _MARK)


@pytest.fixture
def cbtui(request: pytest.FixtureRequest) -> Runner:
    """Runs a node file, a launch file or a lesson, and returns the finished run: ``cbtui("node.py")``."""
    try:
        from cbtui.pytest_plugin.runner import Runner

        return Runner(request)
    except pytest.UsageError as error:
        pytest.fail(str(error), pytrace=False)
    except ImportError as error:
        hidden = (error.name or "").partition(".")[0]
        if hidden not in _OWN_PACKAGES:
            raise
        there = getattr(sys.modules.get(hidden), "__file__", None) or f"a folder {hidden}"
        pytest.fail(
            f"cbtui's own package {hidden} is hidden by {there}; rename that, or keep it off sys.path: start "
            "pytest rather than python -m pytest, with --import-mode=importlib",
            pytrace=False,
        )
