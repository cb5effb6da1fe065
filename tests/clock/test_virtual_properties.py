"""What holds of virtual time whatever the threads do: random sleeps, waits, signals and actions."""

from collections import Counter
from dataclasses import dataclass
from itertools import count, groupby
from typing import TypeAlias

from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.properties import examples
from tests.support.simulation import EndedClock, no_thread_left


@dataclass(frozen=True)
class Sleep:
    length: int


@dataclass(frozen=True)
class Wait:
    """Wait for this thread's own signal, at most ``length``."""

    length: int


@dataclass(frozen=True)
class Set:
    """Set the signal of thread ``whose``."""

    whose: int


@dataclass(frozen=True)
class Ask:
    """Have an action done ``length`` from now."""

    length: int


Step: TypeAlias = Sleep | Wait | Set | Ask

LENGTHS = st.integers(0, 5)
THREADS = 4


def steps() -> st.SearchStrategy[Step]:
    return st.one_of(
        st.builds(Sleep, LENGTHS),
        st.builds(Wait, LENGTHS),
        st.builds(Set, st.integers(0, THREADS - 1)),
        st.builds(Ask, LENGTHS),
    )


Plan: TypeAlias = list[list[Step]]
PLANS = st.lists(st.lists(steps(), max_size=8), min_size=THREADS, max_size=THREADS)


@dataclass(frozen=True)
class Log:
    """A step that a thread took: its place in the order of beginning, its times, and what it brought."""

    thread: int
    step: Step
    place: int
    began: int
    ended: int
    brought: bool | None


def play(plan: Plan) -> tuple[list[Log], list[tuple[int, int]], list[int]]:
    """Run a plan; the steps in order of ending, actions as (asked for, done), and each reading of time."""
    logs: list[Log] = []
    actions: list[tuple[int, int]] = []
    readings: list[int] = []
    places = count()
    with no_thread_left():
        clock = EndedClock()
        signals = [clock.auto_reset_event() for _ in plan]

        def ask(time: int) -> None:
            clock.call_at(time, lambda: actions.append((time, clock.now())))

        def do(me: int, step: Step) -> bool | None:
            match step:
                case Sleep(length):
                    clock.sleep(length)
                case Wait(length):
                    return signals[me].wait(clock.now() + length)
                case Set(whose):
                    signals[whose].set()
                case Ask(length):
                    ask(clock.now() + length)
            return None

        def run(me: int) -> None:
            for step in plan[me]:
                began, place = clock.now(), next(places)
                brought = do(me, step)
                readings.append(clock.now())
                logs.append(Log(me, step, place, began, clock.now(), brought))

        for number in range(len(plan)):
            clock.start_thread(lambda number=number: run(number), f"thread {number}")  # type: ignore[misc]
        clock.sleep(1000)
        clock.wind_up()
    return logs, actions, readings


@settings(deadline=None, max_examples=examples(60))
@given(PLANS)
def test_time_never_goes_back(plan: Plan) -> None:
    _, _, readings = play(plan)
    assert readings == sorted(readings)


@settings(deadline=None, max_examples=examples(60))
@given(PLANS)
def test_every_sleep_ends_exactly_at_its_deadline(plan: Plan) -> None:
    logs, _, _ = play(plan)
    assert all(log.ended - log.began == log.step.length for log in logs if isinstance(log.step, Sleep))


@settings(deadline=None, max_examples=examples(60))
@given(PLANS)
def test_sleeps_that_end_together_end_in_the_order_in_which_they_began(plan: Plan) -> None:
    sleeps = [log for log in play(plan)[0] if isinstance(log.step, Sleep)]
    for _, together in groupby(sleeps, key=lambda log: log.ended):
        places = [log.place for log in together]
        assert places == sorted(places)


@settings(deadline=None, max_examples=examples(60))
@given(PLANS)
def test_every_thread_comes_to_its_end(plan: Plan) -> None:
    logs, _, _ = play(plan)
    done = Counter(log.thread for log in logs)
    assert [done[number] for number in range(THREADS)] == [len(steps) for steps in plan]


@settings(deadline=None, max_examples=examples(60))
@given(PLANS)
def test_every_action_runs_at_its_time_and_in_order(plan: Plan) -> None:
    _, actions, _ = play(plan)
    assert all(asked == done for asked, done in actions)
    assert actions == sorted(actions)


@settings(deadline=None, max_examples=examples(60))
@given(PLANS)
def test_two_runs_are_the_same(plan: Plan) -> None:
    assert play(plan) == play(plan)


@settings(deadline=None, max_examples=examples(60))
@given(PLANS)
def test_no_signal_is_lost_and_none_is_heard_twice(plan: Plan) -> None:
    """Followed step by step, a signal is a flag: a set raises it, a wait that brings True lowers it."""
    logs, _, _ = play(plan)
    raised = [False] * THREADS
    for log in logs:
        match log.step:
            case Set(whose):
                raised[whose] = True
            case Wait(length):
                assert log.brought == raised[log.thread]
                assert log.brought or log.ended - log.began == length
                raised[log.thread] = False
            case _:
                pass
