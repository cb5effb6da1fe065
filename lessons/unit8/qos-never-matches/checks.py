"""What a run of this lesson shows, and what a mended node must do."""

import re

from lessons.checks import (
    Check,
    Verdict,
    calls_of,
    is_called_often,
    never_raises,
    no_problem,
)
from sim.trace.events import LineSaid
from sim.trace.timeline import Timeline

SHOWN = re.compile(r"\d+\.\d degrees")
WARNING = "incompatible QoS"


def _judge_display(run: Timeline) -> Verdict:
    expected = "at least 15 temperatures"
    shown = [line.t for line in run.logs if SHOWN.search(line.text)]
    at = shown[0] if shown else None
    seen = str(len(shown)) if shown else "none"
    return Verdict(len(shown) >= 15, expected, seen, at)


def _judge_sensor(run: Timeline) -> Verdict:
    """The run asks `ros2 topic info -v`, which lists publishers first."""
    expected = "BEST_EFFORT, as it was"
    for line in run.shell:
        if isinstance(line, LineSaid) and "Reliability:" in line.text:
            offered = line.text.split(":")[1].strip()
            return Verdict(offered == "BEST_EFFORT", expected, offered, line.t)
    return Verdict(False, expected, "no publisher of /temperature")


CHECKS = (
    no_problem("qos-mismatch", "sensor and display match"),
    is_called_often("temperature_callback", 35),
    Check("the display shows the temperature", _judge_display),
    Check("the sensor still publishes best effort", _judge_sensor),
    is_called_often("measure", 39),
    never_raises(),
)


def values_that_come(run: Timeline) -> int:
    """Whether all values reach the display, most of them, or none."""
    sent = len(calls_of(run, "measure"))
    came = len(calls_of(run, "temperature_callback"))
    if not came:
        return 2
    return 0 if came >= sent - 1 else 1


def who_tells_you(run: Timeline) -> int:
    """Whether nothing is said, an error ends the program, or it warns."""
    if run.ended is not None and run.ended.failed:
        return 1
    return 2 if any(WARNING in line.text for line in run.logs) else 0
