"""The texts of the pane that asks which thread goes on."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

from cbtui.widgets.lanes.names import short_thread
from sim.trace.descriptions import name_of, why_waiting
from sim.trace.events import ROBOT_THREAD, ChoiceAsked, Reason
from sim.trace.figures.waiting import waits_at
from sim.trace.timeline import Timeline


class ChoiceOption(NamedTuple):
    """A thread that may go on, and its next line; 0 outside of the program."""

    text: str
    file: str = ""
    line: int = 0


@dataclass(frozen=True)
class ChoiceSheet:
    """The content of the pane: the question or the result, and the goal.

    ``kept`` says why the other threads may not go on, ``advised`` is the index of the solution's option.
    """

    news: str
    task: str = ""
    options: tuple[ChoiceOption, ...] = ()
    kept: tuple[str, ...] = ()
    advised: int | None = None
    is_over: bool = False
    """Whether nothing more can be chosen."""


def options_of(question: ChoiceAsked, timeline: Timeline) -> Iterator[ChoiceOption]:
    """Yield the threads that may go on; the first one does if nobody chooses another."""
    callbacks = _callbacks(timeline)
    whole = zip(question.threads, question.functions, question.places, strict=True)
    for number, (thread, function, (file, line)) in enumerate(whole):
        callback = callbacks.get(thread, function)
        about = [*(["runs now"] if question.preempts and not number else []), short_thread(thread)]
        if line:
            where = f"{function if callback == function else f'{callback} in {function}'}, line {line}"
        elif callback:
            where = f"{callback} returns, or raises"
        elif thread == ROBOT_THREAD:
            where, about = "the robot goes on", []
        else:
            where = f"{about.pop()} {'looks for work' if number in question.pooled else 'begins'}"
        yield ChoiceOption(f"{where} ({', '.join(about)})" if about else where, file, line)


def kept_of(question: ChoiceAsked, timeline: Timeline) -> Iterator[str]:
    """Yield why each of the other threads and callbacks may not go on."""
    moment = timeline.moment(timeline.end)
    callbacks = _callbacks(timeline)
    options = zip(question.threads, question.functions, strict=True)
    takes_work = any(not function and thread not in callbacks for thread, function in options)
    waits = {wait.entity: wait for wait in waits_at(moment, timeline)}
    for entity in dict.fromkeys((*moment.waiting, *waits)):
        wait = waits.get(entity)
        free = takes_work and (wait is None or wait.reason is Reason.NO_FREE_WORKER)
        why = ": it is free to run" if wait is None else f": {why_waiting(wait, timeline)}"
        ready = " for a thread that looks for work" if free else why
        yield f"{name_of(entity, timeline)} is ready{ready}"
    yield from (short_thread(each) for each in question.others)
    busy = {*moment.waiting, *(span.entity for span in moment.running.values())}
    idle = [each for each in timeline.entities.values() if each.callback and each.id not in busy]
    if idle:
        known = "not ready, or about to begin" if takes_work else "not ready when the executor last looked"
        yield f"{known}: {', '.join(each.spoken_name for each in idle)}"


def _callbacks(timeline: Timeline) -> dict[str, str]:
    """The name of the callback that each thread runs, by the name of the thread."""
    running = timeline.moment(timeline.end).running.values()
    return {timeline.threads[span.thread].name: name_of(span.entity, timeline) for span in running}
