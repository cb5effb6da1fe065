"""What a run may take before it is ended."""

from cbtui.runs.judged.checking import MOST_TEXT
from cbtui.runs.judged.run_budget import RunBudget
from sim.trace.events import Printed
from sim.trace.timeline import Timeline


class Clock:
    now = 100.0

    def __call__(self) -> float:
        return self.now


def test_a_run_that_takes_too_long_is_told_of() -> None:
    clock = Clock()
    budget = RunBudget(limit=5, clock=clock)
    clock.now += 5
    budget.pass_time()
    assert budget.spent(Timeline(), "mine.py") is None
    clock.now += 0.1
    budget.pass_time()
    assert budget.spent(Timeline(), "mine.py") == (
        "mine.py was given 5 s of real time, and had not come further than 0.000 s"
    )


def test_time_in_which_the_run_stands_does_not_count() -> None:
    clock = Clock()
    budget = RunBudget(limit=5, clock=clock)
    clock.now += 60
    budget.rest()
    clock.now += 4
    budget.pass_time()
    assert budget.spent(Timeline(), "mine.py") is None


def test_a_run_that_writes_too_much_is_told_of() -> None:
    budget = RunBudget(clock=Clock())
    line = Printed(0, "x" * (MOST_TEXT // 2), error=False)
    budget.write([line, line])
    assert budget.spent(Timeline(), "mine.py") is None
    budget.write([Printed(0, "x", error=False)])
    assert budget.spent(Timeline(), "mine.py") == "mine.py wrote more than 32 MB of log by 0.000 s"
