"""What a run of this lesson shows."""

from lessons.checks import SECOND, calls_of, is_called
from sim.trace.model import Window
from sim.trace.timeline import Timeline

SERVICE = "/dummy_server_srv"


def ticks_during_one_call(run: Timeline) -> int:
    """Whether ticks were on time, missing, or late in the first call."""
    call = is_called(SERVICE).windows(run)[0]
    ticks = calls_of(run, "timer_callback", call)
    if not ticks:
        return 1
    late = max(tick.age for tick in ticks) > SECOND // 4
    return 2 if late or len(ticks) < 5 else 0


def ticks_during_three_calls(run: Timeline) -> int:
    """Whether ticks went on, or one came after, or all that were missed."""
    _, *three = is_called(SERVICE).windows(run)
    busy = Window(three[1].start, min(call.end for call in three))
    if calls_of(run, "timer_callback", busy):
        return 0
    after = Window(busy.end, busy.end + SECOND // 4)
    return 1 if len(calls_of(run, "timer_callback", after)) == 1 else 2
