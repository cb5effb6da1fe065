"""Prepares a run for exploring: the program's own lines become switch points, and choices are recorded."""

from collections.abc import Callable

from sim.clock import VirtualClock
from sim.clock.moves import Choice, MovesSchedule
from sim.clock.virtual_threads import VirtualThread
from sim.engine.exploration.asking import AskedChoices, position
from sim.engine.exploration.conflicts import Conflicts
from sim.engine.exploration.line_switches import LineSwitches
from sim.ros.middleware.host import Host
from sim.trace.events import AnyEvent, MachineStalled, ThreadChosen


def explore(clock: VirtualClock, host: Host, record: Callable[[AnyEvent], None]) -> AskedChoices | None:
    """Switch threads at the program's own lines from now on, and record choices and conflicts.

    Returns the object that takes the answers; None for a schedule that does not ask.
    """
    schedule, asked = clock.schedule, None
    if isinstance(schedule, MovesSchedule):
        if schedule.asks:
            asked = AskedChoices(clock, schedule, host, record)
            schedule.decide = asked.decide
        _tell_choices(clock, schedule, record)

    def tell_stall(thread: VirtualThread, duration: int) -> None:
        record(MachineStalled(clock.now(), duration, position(thread)))

    clock.on_stall = tell_stall
    LineSwitches(clock, Conflicts(clock, host.probe.callback_here, record)).start()
    return asked


def _tell_choices(clock: VirtualClock, schedule: MovesSchedule, record: Callable[[AnyEvent], None]) -> None:
    decide = schedule.decide

    def told(choice: Choice) -> int:
        chosen = decide(choice)
        texts = (position(choice.options[0]), position(choice.options[chosen])) if chosen else ("", "")
        able, preempts, state = len(choice.options), choice.preempts, choice.state
        record(ThreadChosen(clock.now(), choice.number, able, chosen, preempts, state, *texts))
        return chosen

    schedule.decide = told
    schedule.now = clock.now
