"""What must hold of a system in every order of its threads, and a search for one in which it does not."""

import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import chain
from random import Random

from sim.clock.strategies import schedule_of
from sim.ros.scheduling.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from sim.trace.events import CallbackStarted, EntityKind, Published
from tests.ros.scheduling.replay import Replay
from tests.ros.scheduling.systems import (
    GRAIN,
    SECONDS,
    TOPICS,
    EntityPlan,
    ServicePlan,
    SourcePlan,
    SubscriptionPlan,
    System,
    TimerPlan,
    play,
)
from tests.support.builder import ns
from tests.support.simulation import Trace

Play = Callable[[System, int], Trace]
"""Runs a system in the order of threads that a seed chooses."""


@dataclass(frozen=True)
class Trouble:
    """A schedule that shows a fault of the executor's: the system is the seed's too."""

    seed: int
    what: str
    system: System

    def __str__(self) -> str:
        return f"seed {self.seed}: {self.what}\n  {self.system}"


def play_seeded(system: System, seed: int) -> Trace:
    """Run a system in the order of threads that a seed chooses."""
    return play(system, schedule_of(seed and f"pct:{seed}"))


def first_trouble(seeds: range, played: Play = play_seeded) -> Trouble | None:
    """The first of some seeds whose system, in its order of threads, breaks a rule."""
    return next((found for seed in seeds if (found := trouble_of(seed, played)) is not None), None)


def trouble_of(seed: int, played: Play = play_seeded) -> Trouble | None:
    """What is wrong with the run of a seed; a run that is stuck or raises is wrong too."""
    system = random_system(Random(seed))
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "MultiThreadedExecutor is used with a single thread")
        try:
            what = next(broken_rules(system, played(system, seed)), None)
        except Exception as error:  # noqa: BLE001 -- whatever comes out of an executor is its fault
            what = f"{type(error).__name__}: {error}"
    return None if what is None else Trouble(seed, what, system)


def random_system(random: Random) -> System:
    """A system as those of ``systems``, with more to wait for at once."""
    kinds = [MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup]
    return System(
        nodes=random.randint(1, 3),
        groups=(random.choice(kinds), random.choice(kinds)),
        entities=tuple(_entity(random) for _ in range(random.randint(2, 6))),
        sources=tuple(_source(random) for _ in range(random.randint(0, 2))),
        threads=random.choice([None, 1, 2, 2, 3, 4]),
        shutdown=random.choice([None, None, random.randint(5, 30)]),
    )


def _source(random: Random) -> SourcePlan:
    return SourcePlan(
        random.choice(TOPICS), random.randint(0, 5), random.randint(1, 10), random.randint(1, 4)
    )


def _entity(random: Random) -> EntityPlan:
    node, group, length = random.randint(0, 2), random.choice([None, 0, 1]), random.randint(0, 8)
    match random.choice(["timer", "timer", "subscription", "subscription", "service"]):
        case "timer":
            then = random.choice(["rest", "publish to a", "publish to b", "call", "call and wait"])
            return TimerPlan(node, group, random.randint(1, 8), length, then)
        case "subscription":
            return SubscriptionPlan(node, group, random.choice(TOPICS), random.randint(1, 4), length)
        case _:
            return ServicePlan(node, group, length)


def broken_rules(system: System, trace: Trace) -> Iterator[str]:
    """Sentences on what should not have happened in a run."""
    return chain(_of_callbacks(system, trace), _of_waits(system, trace), _of_messages(trace))


def _of_callbacks(system: System, trace: Trace) -> Iterator[str]:
    replay = Replay(trace)
    for event in trace.events:
        if isinstance(event, CallbackStarted) and not replay.may_enter(event.entity):
            yield f"two callbacks are in an exclusive group at {event.t / 1e9} s"
        replay.take(event)
        if replay.running.total() > system.workers:
            yield f"more callbacks run than there are threads at {event.t / 1e9} s"


def _of_waits(system: System, trace: Trace) -> Iterator[str]:
    replay = Replay(trace)
    end = SECONDS if system.shutdown is None else system.shutdown * GRAIN
    for now in replay.jumps():
        if now >= ns(end):
            return
        may_run = [entity for entity in replay.ready(now) if replay.may_enter(entity)]
        if may_run and replay.running.total() < system.workers:
            yield f"a wake-up was lost: {trace.names[may_run[0]]} could run at {now / 1e9} s, and did not"


def _of_messages(trace: Trace) -> Iterator[str]:
    replay = Replay(trace)
    list(replay.jumps())
    for entity, appeared in replay.entities.items():
        if appeared.kind == EntityKind.SUBSCRIPTION:
            sent = [each.message for each in trace.of(Published) if each.topic == appeared.name]
            if [*replay.removed[entity], *replay.queues[entity]] != sent:
                yield f"the messages of {appeared.name} were not taken once each, in their order"
