"""The example programs for actions run as they are, as programs of their own beside each other."""

from pathlib import Path

from sim.engine.setup import ProgramSetup, RobotUse, RunSetup
from sim.trace.events import CallbackStarted, EntityAppeared, EntityKind, Logged
from tests.ros.actions import client_programs as clients
from tests.ros.actions import server_programs as servers
from tests.support.engine_runs import SECOND, Run, run_to_end

SEQUENCES = ["[0, 1, 1]", "[0, 1, 1, 2]", "[0, 1, 1, 2, 3]"]
FEEDBACK = [f"Received feedback: array('i', {sequence})" for sequence in SEQUENCES]
ACCEPTED = ["Waiting for action server...", "Sending goal request...", "Goal accepted :)"]
SUCCEEDED = "Goal succeeded! Result: array('i', [0, 1, 1, 2, 3])"


def run(folder: Path, *sources: str, seconds: float = 20.0) -> Run:
    """Run programs side by side, each given by its source."""
    paths = [folder / f"program{number}.py" for number in range(len(sources))]
    for path, source in zip(paths, sources, strict=True):
        path.write_text(source)
    return run_to_end(
        RunSetup(
            title="actions",
            programs=tuple(ProgramSetup(str(path)) for path in paths),
            speed=None,
            until=round(seconds * SECOND),
            robot=RobotUse.NEVER,
        )
    )


def said(run: Run, logger: str) -> list[str]:
    """What one node logged."""
    return [event.text for event in run.events if isinstance(event, Logged) and event.logger == logger]


def said_at(run: Run, text: str) -> list[float]:
    """When a line was logged, in seconds."""
    return [at for at, line in run.logs() if line == text]


def test_the_minimal_client_gets_feedback_and_a_result_from_the_minimal_server(tmp_path: Path) -> None:
    for server in (servers.SERVER, servers.SINGLE_THREADED_SERVER):
        outcome = run(tmp_path, server, clients.CLIENT)
        assert said(outcome, "minimal_action_client") == [*ACCEPTED, *FEEDBACK, SUCCEEDED]
        assert said_at(outcome, SUCCEEDED) == [3.0]
        assert said_at(outcome, FEEDBACK[1]) == [1.0]


def test_the_programs_without_classes_do_the_same(tmp_path: Path) -> None:
    outcome = run(tmp_path, servers.NOT_COMPOSABLE_SERVER, clients.NOT_COMPOSABLE_CLIENT)
    assert said(outcome, "minimal_action_client") == [*ACCEPTED, *FEEDBACK, SUCCEEDED]


def test_the_cancelling_client_stops_the_goal_after_2_seconds(tmp_path: Path) -> None:
    outcome = run(tmp_path, servers.SERVER, clients.CANCELLING_CLIENT)
    assert said(outcome, "minimal_action_client")[-2:] == ["Canceling goal", "Goal successfully canceled"]
    assert said_at(outcome, "Goal successfully canceled") == [2.0]
    assert said(outcome, "minimal_action_server")[-1] == "Goal canceled"


def test_a_single_threaded_server_hears_of_the_cancel_request_only_after_the_goal(tmp_path: Path) -> None:
    outcome = run(tmp_path, servers.SINGLE_THREADED_SERVER, clients.CANCELLING_CLIENT)
    assert said_at(outcome, "Canceling goal") == [2.0]
    assert said_at(outcome, "Goal failed to cancel") == [9.0]


def test_a_deferred_goal_begins_when_the_timer_says(tmp_path: Path) -> None:
    outcome = run(tmp_path, servers.DEFERRING_SERVER, clients.CLIENT)
    assert said_at(outcome, "Executing goal...") == [3.0]
    assert said_at(outcome, SUCCEEDED) == [6.0]


def test_a_second_goal_aborts_the_first_where_one_is_allowed(tmp_path: Path) -> None:
    later = f"import time\ntime.sleep(0.5)\n{clients.CLIENT}"
    outcome = run(tmp_path, servers.SINGLE_GOAL_SERVER, clients.CLIENT, later)
    assert said_at(outcome, "Aborting previous goal") == [0.5]
    assert said_at(outcome, "Goal aborted") == [1.0]
    assert said_at(outcome, "Goal failed with status: 6") == [1.0]
    assert said_at(outcome, SUCCEEDED) == [3.5]


def test_queued_goals_run_one_after_another(tmp_path: Path) -> None:
    outcome = run(tmp_path, servers.QUEUEING_SERVER, clients.CLIENT, clients.CLIENT, clients.CLIENT)
    assert said_at(outcome, "Executing goal...") == [0.0, 3.0, 6.0]
    assert said_at(outcome, SUCCEEDED) == [3.0, 6.0, 9.0]


def test_the_execution_of_a_goal_is_on_the_trace_of_a_program(tmp_path: Path) -> None:
    outcome = run(tmp_path, servers.SERVER, clients.CLIENT)
    shown = {event.entity: event for event in outcome.events if isinstance(event, EntityAppeared)}
    started = [shown[event.entity] for event in outcome.events if isinstance(event, CallbackStarted)]
    assert [each.name for each in started if each.callback == "execute_callback"] == ["/fibonacci"]
    tasks = {each.callback for each in started if each.kind is EntityKind.TASK}
    assert tasks == {"goal_response_callback", "get_result_callback"}
    assert all(each.kind in (EntityKind.WAITABLE, EntityKind.TASK) for each in started)


def test_the_programs_run_on_the_real_clock_too(tmp_path: Path) -> None:
    server, client = tmp_path / "server.py", tmp_path / "client.py"
    server.write_text(servers.SERVER.replace("time.sleep(1)", "time.sleep(0.01)"))
    client.write_text(clients.CLIENT)
    outcome = run_to_end(
        RunSetup(
            title="actions",
            programs=(ProgramSetup(str(server)), ProgramSetup(str(client))),
            clock="real",
            until=3 * SECOND,
            robot=RobotUse.NEVER,
        )
    )
    assert said(outcome, "minimal_action_client")[-1] == SUCCEEDED
