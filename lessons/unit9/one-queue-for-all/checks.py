"""What a run of this lesson shows, and what a mended file must do."""

from lessons.checks import (
    calls_of,
    every_call_answered,
    is_called_often,
    keeps_coming,
    runs_long,
    ticks_on_time,
)
from sim.trace.model import Window
from sim.trace.timeline import Timeline

INSPECTS = runs_long("inspect_callback")

CHECKS = (
    every_call_answered(),
    keeps_coming("belt_callback", INSPECTS, at_least=1.6),
    ticks_on_time("belt_callback", 0.1),
    is_called_often("belt_callback", 20),
)


def belt_during_inspection(run: Timeline) -> int:
    """Whether the belt went on, or stood still, or came between."""
    inspection = INSPECTS.windows(run)[0]
    return 0 if calls_of(run, "belt_callback", inspection) else 1


def first_after_inspection(run: Timeline) -> int:
    """Whether the belt or the label came first after the inspection."""
    after = Window(INSPECTS.windows(run)[0].end, run.end + 1)
    belt = calls_of(run, "belt_callback", after)[0]
    label = calls_of(run, "label_callback", after)[0]
    return 0 if belt.start < label.start else 1
