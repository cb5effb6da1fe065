"""Systems of nodes, and what is smaller than one of them."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

Step = tuple[str, float]
"""A word, and what it is about: seconds, a topic, the place of another entity."""
EVENTS = -1
"""Stands for an EventsExecutor among the threads of executors."""
FUTURES = 2
"""How many futures the callbacks of a system share."""


class Word(NamedTuple):
    """What a step can be: how often it is drawn, and the kinds of callbacks that it can be about."""

    weight: int
    about: tuple[str, ...] = ()
    theme: str = ""
    """What a system has to be about for the step to be drawn; "" for any."""


MADE = ("timer", "subscription", "service")
WORDS = {
    "sleep": Word(6),
    "publish": Word(5, ("subscription",)),
    "ask": Word(2, ("service",)),
    "await": Word(2, ("service",)),
    "task": Word(2),
    "trigger": Word(2, ("guard",)),
    "cancel": Word(1, ("timer",)),
    "reset": Word(1, ("timer",)),
    "raise": Word(0),
    "wait": Word(2, theme="coroutines"),
    "give": Word(2, theme="coroutines"),
    "call": Word(3, ("service",), "calls"),
    "make": Word(2, MADE, "lives"),
    "destroy": Word(1, MADE, "lives"),
    "renew": Word(1, ("service",), "lives"),
    "goal": Word(3, ("action",), "actions"),
    "recall": Word(1, ("action",), "actions"),
    "feedback": Word(0, ("action",), "actions"),
}
THEMES = tuple(dict.fromkeys(word.theme for word in WORDS.values() if word.theme))


@dataclass(frozen=True)
class Callback:
    """An entity with a callback; ``calls`` has the steps of its first calls, the later ones have none."""

    place: int
    kind: str
    node: int
    group: int
    about: float
    """A timer's period in seconds; a subscription's topic; the service of a server."""
    depth: int
    calls: tuple[tuple[Step, ...], ...]
    is_coroutine: bool = False
    is_late: bool = False
    """Whether it is not there until a step makes it."""
    patience: float = 0.3
    """Seconds that it waits for each reply that it cannot go on without."""


@dataclass(frozen=True)
class System:
    """Executors by their threads (0: single-threaded), the executor of each node, groups, callbacks."""

    executors: tuple[int, ...]
    nodes: tuple[int, ...]
    groups: tuple[str, ...]
    callbacks: tuple[Callback, ...]
    end: float

    def scaled(self, factor: float) -> "System":
        """The same, with all times longer by a factor."""
        return replace(
            self,
            end=self.end * factor,
            callbacks=tuple(
                replace(
                    each,
                    about=each.about * factor if each.kind == "timer" else each.about,
                    patience=each.patience * factor,
                    calls=tuple(
                        tuple((word, what * factor if word == "sleep" else what) for word, what in steps)
                        for steps in each.calls
                    ),
                )
                for each in self.callbacks
            ),
        )

    def smaller(self) -> Iterator["System"]:
        """Systems with one thing less: a callback, a call, a step, a thread, a group, a short queue."""
        for each in self.callbacks:
            yield _without_dangling(replace(self, callbacks=_others(self, each)))
        for each in self.callbacks:
            for number, steps in enumerate(each.calls):
                for place in range(len(steps)):
                    less = steps[:place] + steps[place + 1 :]
                    yield self._with(each, calls=(*each.calls[:number], less, *each.calls[number + 1 :]))
            if each.calls and not each.calls[-1]:
                yield self._with(each, calls=each.calls[:-1])
        for each in self.callbacks:
            plain = {"group": 0, "node": 0, "is_coroutine": False, "is_late": False}
            if each.kind == "subscription":
                plain["depth"] = 10
            for name, usual in plain.items():
                if getattr(each, name) != usual:
                    yield self._with(each, **{name: usual})
        for place, threads in enumerate(self.executors):
            if threads > 1:
                yield replace(
                    self, executors=(*self.executors[:place], threads - 1, *self.executors[place + 1 :])
                )
        if len(self.nodes) > 1 and all(each.node < len(self.nodes) - 1 for each in self.callbacks):
            yield replace(self, nodes=self.nodes[:-1])
        if len(self.executors) > 1 and max(self.nodes) < len(self.executors) - 1:
            yield replace(self, executors=self.executors[:-1])

    def _with(self, callback: Callback, **changed: object) -> "System":
        return replace(
            self,
            callbacks=tuple(
                replace(each, **changed) if each is callback else each  # type: ignore[arg-type]
                for each in self.callbacks
            ),
        )


def topics_of(word: str, callbacks: Iterable[Callback]) -> list[float]:
    """What a step with a word can be about, other than seconds: a topic, a place, the number of a future."""
    if word in ("wait", "give"):
        return list(range(FUTURES))
    by_topic = word == "publish"
    return [each.about if by_topic else each.place for each in callbacks if each.kind in WORDS[word].about]


def _others(system: System, callback: Callback) -> tuple[Callback, ...]:
    return tuple(each for each in system.callbacks if each is not callback)


def _without_dangling(system: System) -> System:
    """The same without steps that are about what is not there."""

    def holds(step: Step) -> bool:
        word, what = step
        return not WORDS[word].about or what in topics_of(word, system.callbacks)

    return replace(
        system,
        callbacks=tuple(
            replace(each, calls=tuple(tuple(filter(holds, steps)) for steps in each.calls))
            for each in system.callbacks
        ),
    )
