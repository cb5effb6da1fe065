"""What a run of this lesson shows, and what a mended node must do."""

from lessons.checks import (
    SECOND,
    Check,
    Stretch,
    Verdict,
    every_call_answered,
    keeps_coming,
    log_says,
    never_raises,
    requests_of,
    whole_run,
)
from sim.trace.timeline import Timeline

NODE_RUNS = Stretch("the node runs", lambda run: [whole_run(run)])
LIMIT = 4.0


def _speeds(run: Timeline) -> list[tuple[int, float]]:
    """When the belt told its speed, and which."""
    return [
        (line.t, float(line.text.rpartition("SPEED ")[2]))
        for line in run.logs
        if "SPEED " in line.text
    ]


def _judge_speed(run: Timeline) -> Verdict:
    expected = f"a speed of at most {LIMIT}"
    speeds = _speeds(run)
    if not speeds:
        return Verdict(False, expected, "no speed")
    at, fastest = max(speeds, key=lambda told: told[1])
    return Verdict(fastest <= LIMIT, expected, f"{fastest}", at)


CHECKS = (
    log_says("SPEED 2.0", at_least=3),
    log_says("SPEED 4.0", at_least=8),
    Check("the belt keeps to the limit", _judge_speed),
    keeps_coming("belt_callback", NODE_RUNS, at_least=1.8),
    every_call_answered(),
    never_raises(),
)


def speed_after_the_request(run: Timeline) -> int:
    """Whether the belt runs at the limit, as was asked, or as before."""
    asked = requests_of(run, "/hurry")[0].sent
    later = [speed for t, speed in _speeds(run) if t > asked + SECOND // 5]
    return [4.0, 9.0, 2.0].index(later[0])


def calls_for_one_request(run: Timeline) -> int:
    """Whether the parameter callback was called once, twice, or more."""
    first, second = requests_of(run, "/hurry")[:2]
    asked = [
        line
        for line in run.logs
        if "ASKED FOR" in line.text and first.sent <= line.t < second.sent
    ]
    return min(len(asked), 3) - 1
