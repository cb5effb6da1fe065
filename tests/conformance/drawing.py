"""Draws systems by seeds."""

from collections.abc import Sequence
from dataclasses import replace
from random import Random

from tests.conformance.systems import EVENTS, MADE, THEMES, WORDS, Callback, Step, System, topics_of


def drawn(seed: str) -> System:
    """The system of a seed.

    Its times are of microseconds, so that no two that differ fall into one moment by chance.
    """
    random = Random(seed)
    executors = tuple(random.choice((0, 0, 1, 2, 3, 4, EVENTS)) for _ in range(random.choice((1, 1, 1, 2))))
    nodes = tuple(random.randrange(len(executors)) for _ in range(random.choice((1, 1, 2, 3))))
    groups = ("default", *(random.choice(("exclusive", "exclusive", "reentrant")) for _ in range(3)))
    themes = {each for each in THEMES if random.random() < 0.3}
    others = ["timer", "subscription", "service"]
    if not any(executors):
        others.append("guard")
    kinds = ["timer", *random.choices(others, k=random.randint(2, 5))]
    if "actions" in themes:
        kinds.append("action")
    drafts = []
    for place, kind in enumerate(kinds):
        about = {"timer": random.uniform(0.2, 1.2), "subscription": float(random.randrange(2))}
        node = random.randrange(len(nodes))
        group = random.randrange(len(groups)) * (nodes[node] == nodes[0])  # no group of two executors
        drafts.append(
            Callback(
                place,
                kind,
                node,
                group,
                about.get(kind, place),
                depth=random.choice((1, 2, 10)),
                calls=(),
                is_coroutine="coroutines" in themes and random.random() < 0.5,
                is_late=place > 0 and kind in MADE and "lives" in themes and random.random() < 0.3,
                patience=random.uniform(0.2, 0.6),
            )
        )
    callbacks = tuple(
        replace(each, calls=tuple(_steps(random, each, drafts, themes) for _ in range(random.randint(1, 3))))
        for each in drafts
    )
    return System(executors, nodes, groups, callbacks, 4.0)


def _steps(
    random: Random, callback: Callback, callbacks: Sequence[Callback], themes: set[str]
) -> tuple[Step, ...]:
    words = {word: kind.weight for word, kind in WORDS.items() if kind.theme in {"", *themes}}
    if callback.kind == "action":
        words["feedback"] = 6
    steps: list[Step] = []
    for word in random.choices(list(words), list(words.values()), k=3):
        if word == "sleep":
            steps.append((word, random.uniform(0.08, 0.7)))
        elif word in ("task", "feedback"):
            steps.append((word, 0.0))
        elif choices := topics_of(word, callbacks):
            steps.append((word, random.choice(choices)))
    if random.random() < 0.05:
        steps.append(("raise", 0.0))
    return tuple(steps)
