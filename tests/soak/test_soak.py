"""The soak of the lessons finds what it looks for, and says what it came to, whenever it ends."""

import signal
import sys
from collections import Counter
from collections.abc import Callable
from random import Random

import pytest

from sim.trace.events import (
    AnyEvent,
    CallbackStarted,
    EntityReady,
    MessageDropped,
    Printed,
    Published,
    RunEnded,
)
from sim.trace.integrity.message_counts import MessageCounts
from tests.ros.scheduling.schedules import Trouble, random_system
from tests.soak import keys, lessons, schedules, stdlib_calls
from tests.soak.footprint import footprint, growth
from tests.soak.lesson_runs import SECOND, Came, choose, run_twice
from tests.soak.walks import Walk
from tests.support import engine_runs
from tests.support.builder import Run


def _counts(without: type | None = None) -> list[str]:
    """What does not add up of a run in which a message goes its way, without events of a kind."""
    run = Run("soak")
    thread = run.thread("MainThread")
    group = run.exclusive(run.node("/node"))
    entity = run.subscription(group, "/odom", "odom_callback", lines=(1, 2))
    counts = MessageCounts()
    counts.take(run.events)
    way: list[AnyEvent] = [
        Published(t=1, message=1, topic="/odom", node=0, entity=0),
        EntityReady(t=1, entity=entity, depth=1, message=1),
        Published(t=2, message=2, topic="/odom", node=0, entity=0),
        EntityReady(t=2, entity=entity, depth=2, message=2),
        MessageDropped(t=2, entity=entity, depth=1, message=1),
        CallbackStarted(t=3, entity=entity, thread=thread, message=2, age=1, depth=0),
    ]
    counts.take(event for event in way if without is None or not isinstance(event, without))
    counts.finish()
    return counts.faults


def test_a_message_that_goes_its_way_adds_up() -> None:
    assert _counts() == []


@pytest.mark.parametrize("kind", [Published, EntityReady, MessageDropped])
def test_a_message_that_goes_astray_is_found(kind: type) -> None:
    assert _counts(without=kind)


def test_growth_is_told_from_warming_up() -> None:
    assert growth([1, 5, 9, 10, 10, 10, 10, 10, 10]) == 0
    assert growth([1, 2, 3, 4, 5, 6, 7, 8, 9]) == 3
    assert growth([1, 2]) == 0


def test_a_process_has_a_footprint_until_it_ends() -> None:
    here = footprint()
    assert here is not None
    assert here.memory > 1_000_000
    assert here.threads >= 1
    assert here.files >= 3
    assert footprint(2**22 + 1) is None  # above the highest number of a process


@pytest.mark.slow
def test_a_run_of_the_soak_is_the_same_twice_and_its_messages_add_up() -> None:
    came = run_twice(choose(seed=7, number=2, longest=2.0))
    assert came.troubles == []
    assert came.title == "split-groups"
    assert came.messages > 0
    assert len(came.digest) == 64


def test_a_seed_and_a_number_choose_the_same_run() -> None:
    assert choose(1, 5, 60.0) == choose(1, 5, 60.0)
    assert choose(1, 5, 60.0) != choose(2, 5, 60.0)


def _once(result: object) -> Callable[..., object]:
    """What returns a result, and is told to end when it is called again."""
    results = iter([result])

    def go(*_: object) -> object:
        for each in results:
            return each
        signal.raise_signal(signal.SIGTERM)
        raise AssertionError("nobody heard the signal")

    return go


def test_a_soak_of_lessons_that_is_told_to_end_says_what_it_came_to(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    came = Came("a-lesson", length=72 * SECOND, events=10, messages=4, troubles=["it went astray"])
    monkeypatch.setattr(lessons, "run_twice", _once(came))
    monkeypatch.setattr(sys, "argv", ["soak", "--hours", "9", "--seed", "3"])
    before = signal.getsignal(signal.SIGTERM)
    assert lessons.main() == 1
    out, err = capsys.readouterr()
    assert out.startswith("interrupted: seed 3, 0.02 virtual h twice in 1 runs")
    assert out.endswith("1 in trouble\n")
    assert out.count("\n") == 1
    assert "run 0 (a-lesson): it went astray" in err
    assert signal.getsignal(signal.SIGTERM) is before


def test_a_soak_of_keys_that_is_told_to_end_says_what_it_came_to(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    done = Walk("menu", steps=["a", "b"], reached=Counter(MenuScreen=2))
    monkeypatch.setattr(keys, "walk", _once(done))
    kept: list[tuple[str, str, dict[str, object]]] = []
    monkeypatch.setattr(keys, "record", lambda *what: kept.append(what))
    monkeypatch.setattr(sys, "argv", ["soak", "--steps", "9", "--record"])
    assert keys.main() == 130
    assert capsys.readouterr().out == (
        "interrupted: 2 steps in 1 walks (seed 0), 0 broke something; begun at menu 1; reached MenuScreen 2\n"
    )
    ((soak, part, entry),) = kept
    assert (soak, part) == ("keys", "walks")
    figures = {"steps": 2, "walks": 1, "seconds": 0, "in_vain": 0, "broke": 0}
    assert {**entry, "date": ""} == {"date": "", "seed": 0, **figures}


def test_schedules_are_recorded_if_that_is_wanted(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    kept: list[tuple[str, str, dict[str, object]]] = []
    trouble = Trouble(8, "a wake-up was lost", random_system(Random(8)))
    monkeypatch.setattr(schedules, "_search", lambda *_: [trouble])
    monkeypatch.setattr(schedules, "record", lambda *what: kept.append(what))
    for words in (["soak", "--schedules", "4", "--seed", "7"], ["soak", "--schedules", "4", "--record"]):
        monkeypatch.setattr(sys, "argv", words)
        assert schedules.main() == 1
    ((soak, part, entry),) = kept
    assert (soak, part) == ("schedules", "executors")
    assert {**entry, "date": ""} == {"date": "", "seed": 1, "schedules": 4, "seconds": 0, "faults": 1}
    assert "4 schedules from seed 7, 1 with a fault" in capsys.readouterr().out


def test_a_row_of_the_standard_library_that_takes_too_long_is_found(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    composition = stdlib_calls.compose(2)
    assert composition == stdlib_calls.compose(2)
    assert composition.repeats
    rows = [(place, number) for place, part in enumerate(composition.parts) for number in range(len(part))]
    late: list[AnyEvent] = [
        Printed(t=1, error=False, text=f'came [{place}, {number}, 9000000000, ""]') for place, number in rows
    ]
    run = engine_runs.Run([*late, RunEnded(t=2, reason="it returned", failed=False)])
    assert len(list(stdlib_calls._troubles_of_run(composition, run))) == len(rows)

    kept: list[tuple[str, str, dict[str, object]]] = []
    monkeypatch.setattr(stdlib_calls, "troubles_of", _once(["seed 5: too late"]))
    monkeypatch.setattr(stdlib_calls, "record", lambda *what: kept.append(what))
    monkeypatch.setattr(
        sys, "argv", ["soak", "--minutes", "1e-9", "--seed", "5", "--processes", "1", "--record"]
    )
    monkeypatch.setattr("time.monotonic", iter([0.0, 0.0, 9.0, 9.0]).__next__)
    assert stdlib_calls.main() == 1
    ((soak, part, entry),) = kept
    assert (soak, part) == ("stdlib", "calls")
    assert {**entry, "date": ""} == {"date": "", "seed": 5, "programs": 1, "seconds": 9, "troubles": 1}
    assert capsys.readouterr().err == "seed 5: too late\n"
