"""Systems of nodes, drawn by a seed, and what is smaller than one of them."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from random import Random

Step = tuple[str, float]
"""A word, and what it is about: seconds, a topic, the place of another entity."""


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
            if each.group:
                yield self._with(each, group=0)
            if each.node:
                yield self._with(each, node=0)
            if each.kind == "subscription" and each.depth != 10:
                yield self._with(each, depth=10)
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


def _others(system: System, callback: Callback) -> tuple[Callback, ...]:
    return tuple(each for each in system.callbacks if each is not callback)


def _without_dangling(system: System) -> System:
    """The same without steps that are about what is not there."""
    there = {("publish", each.about) for each in system.callbacks if each.kind == "subscription"}
    there |= {
        (word, each.about) for each in system.callbacks if each.kind == "service" for word in ("ask", "await")
    }
    there |= {("trigger", each.place) for each in system.callbacks if each.kind == "guard"}
    there |= {
        (word, each.place) for each in system.callbacks if each.kind == "timer" for word in _ABOUT_TIMERS
    }
    return replace(
        system,
        callbacks=tuple(
            replace(
                each,
                calls=tuple(
                    tuple(step for step in steps if step[0] in ("sleep", "raise", "task") or step in there)
                    for steps in each.calls
                ),
            )
            for each in system.callbacks
        ),
    )


_ABOUT_TIMERS = ("cancel", "reset")


def drawn(seed: str) -> System:
    """The system of a seed.

    Its times are of microseconds, so that no two that differ fall into one moment by chance.
    """
    random = Random(seed)
    executors = tuple(random.choice((0, 0, 1, 2, 3, 4)) for _ in range(random.choice((1, 1, 1, 2))))
    nodes = tuple(random.randrange(len(executors)) for _ in range(random.choice((1, 1, 2, 3))))
    groups = ("default", *(random.choice(("exclusive", "exclusive", "reentrant")) for _ in range(3)))
    others = (
        ("timer", "subscription", "service")
        if any(executors)
        else ("timer", "subscription", "service", "guard")
    )
    kinds = ["timer", *random.choices(others, k=random.randint(2, 5))]
    drafts = []
    for place, kind in enumerate(kinds):
        about = {"timer": random.uniform(0.2, 1.2), "subscription": float(random.randrange(2))}
        node = random.randrange(len(nodes))
        group = random.randrange(len(groups)) * (nodes[node] == nodes[0])  # no group of two executors
        drafts.append((place, kind, node, group, about.get(kind, place)))
    callbacks = tuple(
        Callback(
            *draft,
            depth=random.choice((1, 2, 10)),
            calls=tuple(_steps(random, drafts) for _ in range(random.randint(1, 3))),
        )
        for draft in drafts
    )
    return System(executors, nodes, groups, callbacks, 4.0)


def _steps(random: Random, drafts: list[tuple[int, str, int, int, float]]) -> tuple[Step, ...]:
    about = {
        kind: [
            place if kind in ("timer", "guard") else what
            for place, each, _, _, what in drafts
            if each == kind
        ]
        for kind in ("timer", "guard", "service", "subscription")
    }
    of_kind = {
        "publish": "subscription",
        "ask": "service",
        "await": "service",
        "trigger": "guard",
        "cancel": "timer",
        "reset": "timer",
    }
    steps: list[Step] = []
    for word in random.choices(
        ("sleep", "publish", "ask", "await", "task", "trigger", "cancel", "reset"),
        (6, 5, 2, 2, 2, 2, 1, 1),
        k=3,
    ):
        if word == "sleep":
            steps.append((word, random.uniform(0.08, 0.7)))
        elif word == "task":
            steps.append((word, 0.0))
        elif choices := about[of_kind[word]]:
            steps.append((word, random.choice(choices)))
    if random.random() < 0.05:
        steps.append(("raise", 0))
    return tuple(steps)
