"""What holds for every test."""

import gc
import multiprocessing
import signal
from collections.abc import Iterator
from contextlib import suppress
from importlib import import_module
from pathlib import Path

import pytest
from textual.notifications import Notification

from cbtui.engines import session
from sim.engine.programs.ending import TO_LEAVE
from tests.support import forked_engines, properties, style_sheets

TESTS = Path(__file__).parent

properties.register_profiles()
for number, handler in ((signal.SIGINT, signal.default_int_handler), (signal.SIGHUP, signal.SIG_DFL)):
    if signal.getsignal(number) == signal.SIG_IGN:
        # As under nohup, whose children would hear neither Ctrl-C nor the terminal's end.
        signal.signal(number, handler)


@pytest.fixture(scope="session", autouse=True)
def state_of_nobody(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Let a console remember what it opened in a folder of the tests', and not in the person's."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_STATE_HOME", str(tmp_path_factory.mktemp("state")))
        yield


@pytest.fixture(scope="session", autouse=True)
def messages_that_stay() -> Iterator[None]:
    """Leave on screen what a console says in passing: on a busy machine it may go before a test looks."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Notification, "time_left", 600.0)
        yield


@pytest.fixture(scope="session", autouse=True)
def style_sheets_read_once() -> Iterator[None]:
    """Spare every console but the first the reading of Textual's style sheets."""
    with style_sheets.read_once():
        yield


@pytest.fixture(scope="session", autouse=True)
def engines_copied() -> Iterator[None]:
    """Spare most engines the imports of their start."""
    with forked_engines.forked():
        yield


@pytest.fixture(scope="session", autouse=True)
def ros_without_shared_memory() -> Iterator[None]:
    """Let real ROS 2 send by UDP: programs that find what an ended one left in shared memory print errors."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("FASTDDS_BUILTIN_TRANSPORTS", "UDPv4")
        yield


@pytest.fixture
def fresh_engines(monkeypatch: pytest.MonkeyPatch) -> None:
    """Start engines as the console does, where the process itself is what is tested."""
    monkeypatch.setattr(session, "SPAWN_CONTEXT", multiprocessing.get_context("spawn"))


@pytest.fixture
def patient_engines(monkeypatch: pytest.MonkeyPatch) -> None:
    """Give programs, where they are to end by themselves, as long for it as a busy machine may need."""
    monkeypatch.setattr(forked_engines, "grace", 120.0)
    monkeypatch.setattr(session, "PROGRAM_EXIT_TIMEOUT", 120.0 + TO_LEAVE)


def pytest_sessionstart(session: pytest.Session) -> None:
    """Let each worker of a whole run compile its part of the tests first, so that none compiles all."""
    worker = getattr(session.config, "workerinput", None)
    if worker is None:
        return
    gc.disable()  # what is imported stays
    if session.config.args_source is not pytest.Config.ArgsSource.TESTPATHS:
        return
    modules = sorted(path.relative_to(session.config.rootpath) for path in TESTS.rglob("test_*.py"))
    for module in modules[int(worker["workerid"].removeprefix("gw")) :: worker["workercount"]]:
        with suppress(Exception):  # the collection tells of it
            import_module(".".join(module.with_suffix("").parts))


def pytest_collection_finish(session: pytest.Session) -> None:
    """Have a worker look for garbage seldom, and never among tests and modules: that took much of its time.

    What no worker runs is left alone: benchmarks tell how long things take with Python's own ways.
    """
    if hasattr(session.config, "workerinput"):
        gc.collect()
        gc.freeze()
        gc.enable()
        gc.set_threshold(10_000)


def pytest_addoption(parser: pytest.Parser) -> None:
    """Let somebody who is going to look at them have the pictures in folders ``goldens`` drawn anew."""
    parser.addoption(
        "--accept-pictures",
        action="store_true",
        help="draw the pictures in tests/**/goldens anew; look at them",
    )
