"""Following a run: its batches in order, whatever ends it, and its engine ended on every way out."""

from collections.abc import Callable
from threading import Event, Thread

import pytest

from cbtui.engines.follow import EngineLostError, FollowedRun, GivenUpError, RunTimeoutError
from cbtui.engines.session import Deliver, Ended
from sim.engine.setup import RunSetup
from sim.trace.events import AnyEvent, RunEnded
from tests.support.fake_session import FakeSession

SETUP = RunSetup(title="test", programs=())
MORE_THAN_WAIT = 200


class Engine:
    """Opens one session, whose reader thread does what a test says."""

    def __init__(self, read: Callable[[Deliver, Ended], None]) -> None:
        self._read = read
        self.reader = Thread(target=lambda: None)

    def __call__(self, setup: RunSetup, deliver: Deliver, ended: Ended) -> FakeSession:
        self.session = FakeSession(setup, deliver, ended, [], 0)
        self.reader = Thread(target=self._read, args=(deliver, ended))
        self.reader.start()
        return self.session


def batch(number: int) -> list[AnyEvent]:
    return [RunEnded(t=number, reason="", failed=False)]


def take_all(engine: Engine, given_up: Event) -> None:
    with FollowedRun(SETUP, engine, given_up) as run:
        for events in run:
            assert events == batch(1)


def test_every_batch_comes_in_order_until_the_run_ends() -> None:
    def read(deliver: Deliver, ended: Ended) -> None:
        for number in range(MORE_THAN_WAIT):
            deliver(batch(number))
        ended(None)

    engine = Engine(read)
    with FollowedRun(SETUP, engine) as run:
        run.start()
        assert [events[0].t for events in run] == list(range(MORE_THAN_WAIT))
    assert engine.session.started
    assert engine.session.stopped


def test_what_came_before_the_engine_was_lost_is_taken_first() -> None:
    def read(deliver: Deliver, ended: Ended) -> None:
        deliver(batch(1))
        ended("it crashed")

    engine = Engine(read)
    with FollowedRun(SETUP, engine) as run:
        assert run.next_batch() == batch(1)
        with pytest.raises(EngineLostError, match="it crashed"):
            run.next_batch()
    assert engine.session.stopped


def test_a_run_that_is_left_holds_no_reader_up() -> None:
    def read(deliver: Deliver, _ended: Ended) -> None:
        for number in range(MORE_THAN_WAIT):
            deliver(batch(number))

    engine = Engine(read)
    with FollowedRun(SETUP, engine) as run:
        assert run.next_batch() == batch(0)
    engine.reader.join()


def test_a_limit_ends_the_waiting_and_a_later_one_counts_instead() -> None:
    engine = Engine(lambda deliver, _ended: deliver(batch(1)))
    with FollowedRun(SETUP, engine) as run:
        run.limit(0)
        run.limit(60)
        assert run.next_batch() == batch(1)
        run.limit(0)
        with pytest.raises(RunTimeoutError):
            run.next_batch()
    assert engine.session.stopped


def test_a_run_can_be_given_up_from_another_thread() -> None:
    given_up = Event()

    def read(deliver: Deliver, _ended: Ended) -> None:
        deliver(batch(1))
        given_up.set()

    engine = Engine(read)
    with pytest.raises(GivenUpError):
        take_all(engine, given_up)
    assert engine.session.stopped


def test_a_run_that_was_given_up_before_is_not_started() -> None:
    given_up = Event()
    given_up.set()
    engine = Engine(lambda _deliver, _ended: None)
    with pytest.raises(GivenUpError), FollowedRun(SETUP, engine, given_up) as run:
        run.start()
    assert not engine.session.started
