"""Runs one after the other: what is delivered for which, and how much may wait."""

import threading

from textual.message import Message

from cbtui.engines.session import Deliver, Ended
from cbtui.runs.live.live_run import LiveRun
from cbtui.screens.parts.runs import RunController
from sim.engine.setup import RunSetup
from sim.trace.events import AnyEvent, Printed
from tests.support.fake_session import FakeEngines


def controller(posted: list[Message], engines: FakeEngines) -> RunController[LiveRun]:
    def make(speed: float | None, deliver: Deliver, ended: Ended) -> LiveRun:
        return LiveRun(RunSetup(title="x", programs=(), speed=speed), engines, deliver, ended)

    return RunController(make, posted.append)


def lines(count: int) -> list[AnyEvent]:
    return [Printed(number, "x", error=False) for number in range(count)]


def test_what_an_earlier_run_delivers_is_not_taken() -> None:
    posted: list[Message] = []
    runs = controller(posted, FakeEngines(lines(3), until=10))
    runs.begin(None)
    first = runs.run
    first.start()
    runs.begin(2.0)
    assert runs.run is not first
    for message in posted:
        assert isinstance(message, RunController.Delivered)
        runs.take(message)
    assert len(runs.timeline.logs) == len(first.timeline.logs) == 0
    assert runs.run.speed == 2.0


def test_a_run_that_is_disowned_is_shown_as_it_was() -> None:
    posted: list[Message] = []
    runs = controller(posted, FakeEngines(lines(3), until=10))
    runs.begin(None)
    run = runs.run
    runs.disown()
    run.start()
    (message,) = posted
    assert isinstance(message, RunController.Delivered)
    runs.take(message)
    assert runs.run is run
    assert not run.timeline.logs


def test_another_thread_waits_until_the_screen_has_taken_something() -> None:
    posted: list[Message] = []
    runs = controller(posted, FakeEngines([], until=0))
    runs.begin(None)
    source = threading.Thread(target=runs.deliver, args=(runs.number, lines(256 * 6)))
    source.start()
    taken = 0
    while taken < 6:
        assert len(posted) - taken <= 5
        if len(posted) > taken:
            message = posted[taken]
            assert isinstance(message, RunController.Delivered)
            runs.take(message)
            taken += 1
    source.join()
    assert len(runs.timeline.logs) == 256 * 6
