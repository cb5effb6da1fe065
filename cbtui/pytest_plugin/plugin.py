"""The mark, the options and the fixture; pytest always loads this, and the rest of cbtui only for a test."""

from __future__ import annotations

from collections.abc import Generator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from cbtui.text.clashing_packages import on_hidden, on_hiding

if TYPE_CHECKING:
    from cbtui.pytest_plugin.runner import Runner

_MARK = (
    "cbtui(seconds=10, calls=(), lines=(), arguments=(), threads=None, groups={}, periods={}, "
    "sensor_rate=None, distro=None, schedules=1, seed=None, on='model', python=None, robot=True, limit=60): "
    "how the fixture cbtui runs programs"
)


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
        clash = on_hidden(error)
        if not clash:
            raise
        pytest.fail(
            f"{clash}: start pytest rather than python -m pytest, with --import-mode=importlib", pytrace=False
        )


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item, call: pytest.CallInfo[None]
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Name the package of cbtui's that hides one which a test imports."""
    report = yield
    _add_clash(report, call, item.path)
    return report


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(
    collector: pytest.Collector,
) -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
    """Name the package of cbtui's that hides one which a file of tests imports."""
    report = yield
    _add_clash(report, getattr(report, "call", None), collector.path)
    return report


def _add_clash(
    report: pytest.TestReport | pytest.CollectReport, call: pytest.CallInfo[Any] | None, file: Path
) -> None:
    raised = None if call is None or call.excinfo is None else call.excinfo.value
    for error in (raised, getattr(raised, "__cause__", None)):
        if isinstance(error, ImportError) and (clash := on_hiding(error, file)):
            report.sections.append(("cbtui", clash))
