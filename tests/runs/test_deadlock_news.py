"""Deadlocks are told while a run goes on."""

from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager
from pathlib import Path

import pytest

from cbtui.runs.headless.deadlock_news import DeadlockNews
from cbtui.runs.headless.headless import run_headless
from sim.diagnosis.diagnoses import diagnose
from sim.ros.node.node import Node
from sim.ros.scheduling.callback_groups import MutuallyExclusiveCallbackGroup
from sim.trace.events import AnyEvent, Notice, NoticeKind, Severity
from sim.trace.timeline import Timeline
from tests.diagnosis.findings import SetBool, diagnosed, once, serve_outside, spin
from tests.support.builder import ns
from tests.support.engine_runs import program_setup
from tests.support.runs import shared_group_run
from tests.support.simulation import Simulation

HALF = ns(0.5)


@pytest.fixture(autouse=True)
def no_pause(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the rules be asked at any real time: the timeline of a test grows by seconds at once."""
    monkeypatch.setattr("cbtui.runs.live.findings._MIN_INTERVAL", 0.0)
    monkeypatch.setattr("cbtui.runs.live.findings._TIME_SHARE", 1e9)


def stuck_at_three() -> list[AnyEvent]:
    """The events of a run in which a callback at 3 s calls a service whose reply its own group keeps out."""

    def program(simulation: Simulation) -> None:
        serve_outside(simulation)
        node = Node("n")
        client = node.create_client(SetBool, "/outside")

        def ask() -> None:
            client.call(SetBool.Request())

        once(node, 3.0, ask)
        node.create_timer(0.5, lambda: None, callback_group=MutuallyExclusiveCallbackGroup())
        spin(node, 2)

    return diagnosed(program).trace.events


def batches(events: Sequence[AnyEvent]) -> Iterator[list[AnyEvent]]:
    """Ten seconds of events, a batch for each half second."""
    for half in range(20):
        yield [each for each in events if half * HALF <= each.t < (half + 1) * HALF]


def told(events: Sequence[AnyEvent]) -> Iterator[tuple[float, str]]:
    """The news on a run, with their times in seconds."""
    timeline = Timeline()
    news = DeadlockNews(timeline)
    for batch in batches(events):
        timeline.extend(batch)
        for sentence in news.news():
            yield timeline.end / ns(1.0), sentence


def test_a_deadlock_is_told_once_within_two_seconds_with_what_is_waited_for_and_the_line() -> None:
    [(at, sentence)] = told(stuck_at_three())
    assert 3.0 <= at <= 5.0
    assert sentence.startswith("deadlock: ask waits for /outside for ever; ")
    assert sentence.count("test_deadlock_news.py:") == 1


def test_other_problems_are_left_to_the_end() -> None:
    assert list(told(shared_group_run().until(9.0))) == []


class Played(AbstractContextManager["Played"]):
    """In place of a run of an engine: the events of the deadlock."""

    def __init__(self, *_: object) -> None:
        self.session = None

    def __exit__(self, *_: object) -> None: ...

    def start(self) -> None: ...

    def __iter__(self) -> Iterator[list[AnyEvent]]:
        return batches(stuck_at_three())


@pytest.mark.parametrize(("clock", "times"), [("real", 1), ("virtual", 0)])
def test_a_run_on_the_real_clock_writes_it_to_standard_error(
    clock: str, times: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("cbtui.runs.headless.headless.FollowedRun", Played)
    run_headless(program_setup(Path("node.py"), 10.0, clock))
    said = capsys.readouterr()
    assert said.err.count("cbtui: deadlock: ask waits for /outside for ever") == times
    assert said.out.count("deadlock: ") == 1


def test_a_callback_of_which_a_deadlock_is_told_is_not_told_to_hang_as_well() -> None:
    timeline = Timeline()
    news, events = DeadlockNews(timeline), stuck_at_three()
    timeline.extend([each for each in events if each.t < ns(4.2)])
    entity = next(each.subject for each in diagnose(timeline) if each.ring)
    hangs = [
        Notice(ns(4.2), Severity.WARN, "has not come back", each, kind=NoticeKind.NO_PROGRESS)
        for each in (entity, entity + 1)
    ]
    news.news()
    timeline.extend(hangs)
    assert len(news.news(hangs)) <= 1
    assert news.without_told([*hangs]) == hangs[1:]
