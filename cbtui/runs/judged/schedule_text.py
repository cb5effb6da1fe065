"""Sentences about one schedule: its moves, and the accesses to shared data that conflict in it."""

from pathlib import Path

from sim.quantities.durations import duration, timestamp
from sim.trace.events import AccessesConflicted, MachineStalled, ThreadChosen
from sim.trace.timeline import Timeline


def step_text(choice: ThreadChosen) -> str:
    """Say which thread goes on in place of which."""
    how = "stops" if choice.preempts else "waits"
    return f"{timestamp(choice.t)} {choice.left} {how}; {choice.follows} goes on"


def stall_text(stall: MachineStalled) -> str:
    """Say what time passes before which thread goes on."""
    passed = duration(stall.duration)
    return f"{timestamp(stall.t)} the machine is slow: {passed} pass before {stall.before} goes on"


def conflict_text(conflict: AccessesConflicted, timeline: Timeline) -> str:
    """Say where data was used twice, and where in between."""
    uses = []
    for (file, line), writes, entity in zip(conflict.places, conflict.writes, conflict.entities, strict=True):
        known = timeline.entities.get(entity)
        who = "" if known is None else f" ({known.spoken_name})"
        uses.append(f"{Path(file).name}:{line}{who} {'writes' if writes else 'reads'} it")
    return f"{conflict.name.removeprefix('.')}: {', then '.join(uses)}"
