"""The example programs with executors, groups and guard conditions run as they are."""

from pathlib import Path

import pytest

from sim.engine.setup import ProgramSetup, RobotUse, RunSetup
from sim.trace.events import GroupAppeared, GroupKind, Logged, ThreadAppeared
from tests.ros.scheduling import executor_programs as programs
from tests.support.engine_runs import SECOND, Run, run_to_end


def run(folder: Path, *sources: str, seconds: float = 3.5) -> Run:
    """Run programs side by side, each given by its source, beside the package of the examples."""
    package = folder / "examples_rclpy_executors"
    package.mkdir()
    (package / "__init__.py").touch()
    (package / "listener.py").write_text(programs.LISTENER)
    (package / "talker.py").write_text(programs.TALKER)
    paths = [folder / f"program{number}.py" for number in range(len(sources))]
    for path, source in zip(paths, sources, strict=True):
        path.write_text(source)
    return run_to_end(
        RunSetup(
            title="executors",
            programs=tuple(ProgramSetup(str(path)) for path in paths),
            speed=None,
            until=round(seconds * SECOND),
            robot=RobotUse.NEVER,
            distro="kilted",  # the first with ``with rclpy.init():``
        )
    )


def said(run: Run, logger: str) -> list[tuple[float, str]]:
    """When a node logged what."""
    return [
        (event.t / SECOND, event.text)
        for event in run.events
        if isinstance(event, Logged) and event.logger == logger
    ]


HEARD = [(float(second), f"I heard: [Hello World: {second - 1}]") for second in (1, 2, 3)]


def test_talker_and_listener_as_two_programs(tmp_path: Path) -> None:
    assert said(run(tmp_path, programs.LISTENER, programs.TALKER), "listener") == HEARD


def test_two_nodes_composed_in_one_executor(tmp_path: Path) -> None:
    assert said(run(tmp_path, programs.COMPOSED), "listener") == HEARD


def test_two_timers_of_one_exclusive_group(tmp_path: Path) -> None:
    outcome = run(tmp_path, programs.CALLBACK_GROUP, seconds=1.7)
    assert [at for at, _ in said(outcome, "double_talker")] == [0.5, 1.0, 1.0, 1.5]
    assert [text for _, text in said(outcome, "listener")] == [
        f"I heard: [Hello World: {i}]" for i in range(4)
    ]


@pytest.mark.parametrize(
    "source", [programs.CUSTOM_EXECUTOR, programs.HUMBLE_CUSTOM_EXECUTOR], ids=["jazzy", "humble"]
)
def test_an_executor_of_the_programs_own_with_two_pools(tmp_path: Path, source: str) -> None:
    outcome = run(tmp_path, source, programs.ESTOP)
    assert said(outcome, "listener") == HEARD
    assert said(outcome, "estopper") == [(1.2, "I heard: [stop]")]
    names = {event.thread: event.name for event in outcome.events if isinstance(event, ThreadAppeared)}
    threads = {
        event.logger: names[event.thread]
        for event in outcome.events
        if isinstance(event, Logged) and event.text.startswith("I heard")
    }
    assert threads == {"listener": "ThreadPoolExecutor-1_0", "estopper": "ThreadPoolExecutor-0_0"}


def test_a_group_of_the_programs_own_lets_in_as_many_as_it_has_tokens(tmp_path: Path) -> None:
    outcome = run(tmp_path, programs.CUSTOM_CALLBACK_GROUP, seconds=3.2)
    lines = said(outcome, "intra_process_throttled_talker_listener")
    kinds = [event.kind for event in outcome.events if isinstance(event, GroupAppeared)]
    assert GroupKind.CUSTOM in kinds
    # Ten tokens are there from the beginning, and one more comes every half second.
    for at, _ in lines:
        assert sum(before <= at for before, _ in lines) <= 10 + int(at / 0.5)
    assert len(lines) == 10 + 6
    assert lines[0] == (0.1, 'Publishing: "Hello World: 0"')


def test_a_guard_condition_that_is_triggered_between_two_spins(tmp_path: Path) -> None:
    outcome = run(tmp_path, programs.GUARD_CONDITION, seconds=20.0)
    assert said(outcome, "demo_guard_condition") == [
        (5.0, "spun"),
        (5.0, "guard callback called"),
        (5.0, "spun"),
    ]
