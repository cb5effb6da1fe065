"""What a run of this lesson shows."""

from lessons.checks import SECOND, calls_of, is_called, requests_of
from sim.trace.timeline import Timeline

SERVICE = "/dummy_server_srv"


def ticks_during_one_call(run: Timeline) -> int:
    """Whether ticks were on time, late, or missing in the first call."""
    call = is_called(SERVICE).windows(run)[0]
    ticks = calls_of(run, "timer_callback", call)
    if not ticks:
        return 2
    late = max(tick.age for tick in ticks) > SECOND // 4
    return 1 if late or len(ticks) < 5 else 0


def answer_of_three_calls(run: Timeline) -> int:
    """Whether the last of three calls was answered in 5, 10 or 15 s."""
    _, *three = requests_of(run, SERVICE)
    last = max(call.replied or run.end for call in three)
    return round((last - three[0].sent) / (5 * SECOND)) - 1
