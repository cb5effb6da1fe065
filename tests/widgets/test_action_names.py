"""The two ends of an action have names of their own, and what the server is asked is told while it waits."""

import pytest

from cbtui.widgets.diagnosis import diagnosis_at
from sim.diagnosis import diagnose
from sim.trace.figures.concurrency import Concurrency
from sim.trace.figures.summary import summarise
from sim.trace.timeline import Timeline
from tests.support.builder import ns
from tests.support.engine_runs import run_lesson


@pytest.fixture(scope="module")
def cancelled() -> Timeline:
    """A goal sent at 2.5 s and cancelled at 4.0 s, while the server's only thread runs it."""
    return run_lesson("cancel-never-served", 10.0, 2.5).timeline


def test_the_server_of_an_action_is_told_from_its_client(cancelled: Timeline) -> None:
    names = {each.name for each in summarise(cancelled).callbacks}
    assert {"/fetch_it client", "/fetch_it server", "execute_callback"} <= names


@pytest.mark.parametrize(
    ("at", "told"),
    [
        (3.0, "/fetch_it server (asked for the result) waits 500 ms"),
        (5.0, "/fetch_it server (asked to cancel after 1.5 s) waits 2.5 s"),
    ],
)
def test_what_the_server_of_an_action_is_asked_has_a_time_of_its_own(
    cancelled: Timeline, at: float, told: str
) -> None:
    line = diagnosis_at(cancelled, ns(at), Concurrency(cancelled)).at_length
    assert line == f"{told}: its only thread runs execute_callback"


def test_a_diagnosis_tells_when_in_its_wait_a_server_was_asked_to_cancel(cancelled: Timeline) -> None:
    (found,) = (each for each in diagnose(cancelled) if each.rule.id == "no-free-worker")
    told = found.explained(cancelled).what
    server = "/fetch_it server (asked to cancel after 1.5 s) waited 5.0 s"
    assert told == f"{server}: its only thread ran execute_callback"
