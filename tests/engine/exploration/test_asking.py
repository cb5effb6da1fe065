"""A run that asks which thread goes on, and plays what it is told."""

from collections.abc import Callable
from pathlib import Path

import msgspec

from cbtui.engines.follow import FollowedRun
from cbtui.engines.session import ProcessSession
from cbtui.runs.setup.lesson_setup import RunRequest, setup_for
from cbtui.widgets.choice import options_of
from lessons.catalogue import find
from sim.engine.commands import Choose, Command, Resume
from sim.trace.events import AnyEvent, ChoiceAsked, CommandGiven, CommandKind, Printed, RunEnded, ThreadChosen
from sim.trace.timeline import Timeline

PROGRAM = """
import threading, time
n, lock = 0, threading.Lock()

def add():
    global n
    m = n
    n = m + 1

def late():
    with lock:
        pass

def main():
    with lock:
        for target in (add, add, late):
            threading.Thread(target=target, name=target.__name__).start()
        time.sleep(1)
    print("n is", n)
"""


def asked(
    tmp_path: Path,
    answer: Callable[[ChoiceAsked], Command],
    seed: str | None = "ask:",
    program: str = PROGRAM,
    explored_from: int = 0,
) -> list[AnyEvent]:
    """All events of a run whose questions are answered."""
    path = tmp_path / "mine.py"
    path.write_text(program)
    setup = RunRequest(files=[path], clock="virtual", seconds=2).setup()
    setup = msgspec.structs.replace(setup, seed=seed, explored_from=explored_from)
    events: list[AnyEvent] = []
    with FollowedRun(setup, ProcessSession) as run:
        run.start()
        run.limit(60)
        for batch in run:
            events += batch
            for event in batch:
                if isinstance(event, ChoiceAsked):
                    run.session.send(answer(event))
    return events


def printed(events: list[AnyEvent]) -> str:
    return "".join(event.text for event in events if isinstance(event, Printed))


def test_time_stands_at_each_choice_until_it_is_told_who_goes_on(tmp_path: Path) -> None:
    answers = iter([2, 1, 1])

    def answer(question: ChoiceAsked) -> Command:
        return Choose(next(answers, 0))

    events = asked(tmp_path, answer)
    questions = [event for event in events if isinstance(event, ChoiceAsked)]
    first = questions[0]
    assert not first.preempts
    assert first.threads == ("add", "add", "late")
    assert first.functions == ("", "", "")  # they have not begun
    functions = {function for question in questions for function in question.functions}
    assert functions == {"", "add", "late", "main"}
    assert any(other.startswith("MainThread (mine.py:18") for other in first.others)
    late = [other for question in questions for other in question.others if other.startswith("late")]
    assert "late (mine.py:11, in late) waits for lock, which MainThread took at mine.py:15, in main" in late
    moves = [event.chosen for event in events if isinstance(event, ThreadChosen)]
    assert moves[:3] == [2, 1, 1]
    assert "n is 1" in printed(events)
    given = [event for event in events if isinstance(event, CommandGiven)]
    assert all(event.kind is CommandKind.CHOOSE for event in given)
    assert isinstance(events[-1], RunEnded)


def test_moves_are_played_before_anything_is_asked(tmp_path: Path) -> None:
    events = asked(tmp_path, lambda _: Choose(0), "ask:1=1")
    first = next(event for event in events if isinstance(event, ChoiceAsked))
    assert first.number == 2


def test_a_run_that_is_told_to_go_on_asks_no_more(tmp_path: Path) -> None:
    events = asked(tmp_path, lambda _: Resume())
    assert sum(isinstance(event, ChoiceAsked) for event in events) == 1
    assert "n is 2" in printed(events)


AGAIN = """
    for target in (add, add):
        threading.Thread(target=target).start()
    time.sleep(0.5)
    print("n is", n)
"""
TWICE = PROGRAM.replace('    print("n is", n)\n', AGAIN)
WRITES = TWICE.splitlines().index("    n = m + 1") + 1


def test_up_to_a_moment_a_run_is_as_usual_and_asks_from_there_on(tmp_path: Path) -> None:
    def before(events: list[AnyEvent]) -> list[AnyEvent]:
        return [event for event in events if event.t < 900_000_000]

    usual = asked(tmp_path, lambda _: Choose(0), None, TWICE)

    def answer(question: ChoiceAsked) -> Command:
        return Choose(int(question.preempts and question.places[0][1] == WRITES))

    events = asked(tmp_path, answer, "ask:", TWICE, 900_000_000)
    assert before(events) == before(usual)
    assert "n is 4" in printed(usual)
    assert "n is 3" in printed(events)
    questions = [event for event in events if isinstance(event, ChoiceAsked)]
    assert questions[0].number == 0
    assert questions[0].t == 1_000_000_000


POOL = """
from concurrent.futures import ThreadPoolExecutor

def add(number):
    return number + 1

def main():
    with ThreadPoolExecutor(2) as pool:
        print(*pool.map(add, range(2)))
"""


def test_workers_of_a_pool_are_told_from_other_threads(tmp_path: Path) -> None:
    events = asked(tmp_path, lambda _: Choose(1), program=POOL)
    questions = [event for event in events if isinstance(event, ChoiceAsked)]
    for each in questions:
        workers = [place for place, thread in enumerate(each.threads) if "ThreadPoolExecutor" in thread]
        assert list(each.pooled) == workers
    assert any(each.pooled for each in questions)
    assert not any(
        event.pooled for event in asked(tmp_path, lambda _: Choose(0)) if isinstance(event, ChoiceAsked)
    )


def test_a_thread_that_has_left_its_callback_is_not_told_to_be_at_the_line_that_spins() -> None:
    setup = setup_for(find("single-thread"), speed=None)
    setup = msgspec.structs.replace(setup, seed="ask:", explored_from=950_000_000, until=1_100_000_000)
    timeline, told = Timeline(), []
    with FollowedRun(setup, ProcessSession) as run:
        run.start()
        run.limit(60)
        for batch in run:
            timeline.extend(batch)
            for question in [each for each in batch if isinstance(each, ChoiceAsked)]:
                told += [option.text for option in options_of(question, timeline)]
                run.session.send(Choose(0))
    assert told[:2] == ["timer_callback returns, or raises (runs now, MainThread)", "the robot goes on"]
