"""Sentences about one schedule: its moves, and the accesses to shared data that conflict in it."""

from collections.abc import Sequence
from pathlib import Path

from sim.clock.moves import moves_of, moves_text
from sim.clock.schedule import Seed
from sim.quantities.durations import duration, timestamp
from sim.trace.events import AccessesConflicted, MachineStalled, ThreadChosen
from sim.trace.timeline import Timeline


def step_text(choice: ThreadChosen) -> str:
    """Say which thread goes on in place of which."""
    how = "stops" if choice.preempts else "waits"
    return f"{timestamp(choice.t)} {choice.left} {how}; {choice.follows} goes on"


def unplayed_text(seed: Seed | None, choices: Sequence[ThreadChosen]) -> str:
    """Say that a run did not come to all moves of its seed, and why not to the first; "" if it did."""
    if not isinstance(seed, str) or not seed.startswith("moves:"):
        return ""
    made = {each.number: each for each in choices}
    lost = {at: move for at, move in moves_of(seed).items() if at not in made or made[at].chosen != move}
    if not lost:
        return ""
    first = min(lost)
    had = (
        f"choice {first} was among {made[first].able} threads"
        if first in made
        else f"there were {len(made)} choices"
    )
    return f"{moves_text(lost)} was not played: {had}, counted from 0"


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
