"""The two ends of an action have names of their own, and what the server is asked is told while it waits."""

from cbtui.widgets.diagnosis import diagnosis_at
from sim.diagnosis import diagnose
from sim.trace.figures.concurrency import Concurrency
from sim.trace.figures.summary import summarise
from tests.support.builder import ns
from tests.support.engine_runs import run_lesson


def test_the_server_of_an_action_is_told_from_its_client_and_is_asked_to_cancel() -> None:
    timeline = run_lesson("cancel-never-served", 10.0, 2.5).timeline
    names = {each.name for each in summarise(timeline).callbacks}
    assert {"/fetch_it client", "/fetch_it server", "execute_callback"} <= names
    line = diagnosis_at(timeline, ns(5.0), Concurrency(timeline)).at_length
    assert line == "/fetch_it server (asked to cancel) waits 2.5 s: its only thread runs execute_callback"
    (found,) = (each for each in diagnose(timeline) if each.rule.id == "no-free-worker")
    told = found.rule.explain(found, timeline).what
    assert told == "/fetch_it server (asked to cancel) waited 5.0 s: its only thread ran execute_callback"
