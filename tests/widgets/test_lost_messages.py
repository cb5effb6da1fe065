"""A message that its queue loses while its callback's own last call runs has waited for nothing."""

from io import StringIO

import pytest

from cbtui.widgets.lanes.details import details_of
from lessons.checks.limits import never_waits_longer_than
from lessons.checks.reading import whole_run
from sim.export.csv import CallTable
from sim.quantities.durations import duration
from sim.trace.events import Reason, WaitEnded
from sim.trace.figures.comparison import compare
from sim.trace.figures.summary import summarise
from tests.support.builder import ns
from tests.support.runs import Run
from tests.widgets.pictures import told


@pytest.mark.parametrize(("busy", "waited"), [(0.0, 0.05), (0.2, 0.25)], ids=["own call", "another's too"])
def test_it_counts_in_no_figure_and_no_pane(busy: float, waited: float) -> None:
    run = Run()
    group, thread = run.exclusive(run.node("/n")), run.thread("MainThread")
    detect, beat = run.subscription(group, "/frame", "detect", depth=1), run.timer(group, "beat", 1.0)
    run.message(detect, 1.0)
    run.callback(detect, thread, 1.0, 0.55)
    for place in range(1, 8 if busy else 6):
        run.message(detect, 1.0 + place / 10)
    run.wait(detect, 1.1, None, Reason.GROUP_HELD, detect)
    if busy:
        run.wait_changes(detect, 1.55, 1.1, Reason.GROUP_HELD, beat)
        run.callback(beat, thread, 1.55, busy)
    run.add(WaitEnded(ns(1.55 + busy), detect))
    run.callback(detect, thread, 1.55 + busy, 0.1)
    timeline = told(run, until=2.0)
    in_summary = next(each.longest_wait for each in summarise(timeline).callbacks if each.name == "detect")
    assert in_summary is not None
    assert in_summary.length == ns(waited)
    assert in_summary.why == f"group A held by {'beat' if busy else 'detect'}"
    pairs = compare(timeline, timeline, whole_run(timeline)).callbacks
    in_comparison = next(pair.first for pair in pairs if pair.name == "detect")
    assert in_comparison is not None
    assert in_comparison.longest_wait == ns(waited)
    last = timeline.spans_of(detect, whole_run(timeline))[-1]
    why = "group A held by beat" if busy else "its last call still ran"
    facts = "; ".join(details_of(timeline, last, ns(2.0)).facts)
    assert f"waited {duration(ns(waited))}: " in facts
    assert why in facts
    table = StringIO()
    rows = CallTable(table)
    rows.take(run.events)
    rows.finish()
    waits = [line.split(",")[3] for line in table.getvalue().splitlines() if ",detect," in line]
    assert waits[-1] == f"{waited:.9f}"
    assert not never_waits_longer_than("detect", waited / 2).judge(timeline).passed
    assert never_waits_longer_than("detect", waited).judge(timeline).passed
