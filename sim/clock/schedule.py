"""Chooses the thread that goes on where a real machine could choose any: by arrival, or by a seed.

All choices that a run on virtual time leaves open are made here; nothing here waits or knows a clock. The
caller decides what identifies a thread.
"""

from collections.abc import Callable, Hashable, Sequence
from itertools import count
from random import Random
from typing import Protocol, TypeAlias

from sim.clock.played import NO_ACCESSES, Accesses, Played, Walked, moves_of

Seed: TypeAlias = int | str
"""What names a schedule, as ``schedule_of`` reads it."""


class Schedule(Protocol):
    """Makes the choices of one run. Used by one thread at a time, the one that has the baton."""

    explores: bool
    """Whether it may choose another than the first; if not, switch points need not ask it."""

    def next(self, ready: Sequence[Hashable]) -> int:
        """The index in ``ready``, oldest first, of the thread that goes on."""

    def leaves(self, running: Hashable, ready: Sequence[Hashable], accesses: Accesses = NO_ACCESSES) -> bool:
        """Whether a thread that could go on lets one of ``ready`` go first.

        ``accesses`` is what its next step touches, where that is one of the program's own.
        """

    def choose(self, number: int) -> int:
        """The index of the chosen one of ``number`` equals; 0 came first."""

    def hands_over(self) -> bool:
        """Whether a released lock goes to a waiting thread, instead of to the next thread that asks."""

    def did(self, thread: Hashable, what: Hashable) -> None:
        """A thread has done something with ``what``; called only if the schedule ``explores``."""

    def forget(self, thread: Hashable) -> None:
        """A thread has ended."""


class FirstCome:
    """First come, first served; a thread goes on until it waits."""

    explores = False

    def next(self, ready: Sequence[Hashable]) -> int:
        """The thread that has waited longest."""
        return 0

    def leaves(self, running: Hashable, ready: Sequence[Hashable], accesses: Accesses = NO_ACCESSES) -> bool:
        """Never."""
        return False

    def choose(self, number: int) -> int:
        """The first."""
        return 0

    def hands_over(self) -> bool:
        """Always."""
        return True

    def did(self, thread: Hashable, what: Hashable) -> None:
        """Nothing to do."""

    def forget(self, thread: Hashable) -> None:
        """Nothing to do."""


class RandomWalk:
    """The choices of a seed, each of them among all threads that can go on, equally likely."""

    explores = True

    def __init__(self, seed: int) -> None:
        self._random = Random(seed)

    def next(self, ready: Sequence[Hashable]) -> int:
        """Any of them."""
        return self.choose(len(ready))

    def leaves(self, running: Hashable, ready: Sequence[Hashable], accesses: Accesses = NO_ACCESSES) -> bool:
        """Whenever there is another one: it is among those that ``next`` chooses from."""
        return len(ready) > 0

    def choose(self, number: int) -> int:
        """Any of them."""
        return self._random.randrange(number) if number > 1 else 0

    def hands_over(self) -> bool:
        """As often as not."""
        return self.choose(2) == 0

    def did(self, thread: Hashable, what: Hashable) -> None:
        """Nothing to do."""

    def forget(self, thread: Hashable) -> None:
        """Nothing to do."""


class Seeded(RandomWalk):
    """The choices of a seed: the same seed and the same questions give the same answers.

    Every thread gets a random priority when it is first seen, and the highest goes on. At each decision, with
    a probability that the seed draws once, the thread that would go on falls below all others. So some seeds
    keep a thread slow for long, as no series of independent draws would, and others switch all the time.

    This is probabilistic concurrency testing (Burckhardt, Kothari, Musuvathi and Nagarakatte: A Randomized
    Scheduler with Probabilistic Guarantees of Finding Bugs, ASPLOS 2010), with recurring change points, since
    nodes run for ever, in place of a fixed number of them.
    """

    _CHANGE_RATES = (0.5, 0.2, 0.05, 0.01)

    def __init__(self, seed: int) -> None:
        super().__init__(seed)
        self._rate = self._random.choice(self._CHANGE_RATES)
        self._priorities: dict[Hashable, float] = {}
        self._lowest = count(-1, -1)

    def next(self, ready: Sequence[Hashable]) -> int:
        """The thread of the highest priority, or, at a change point, of the second highest."""
        place = self._highest(ready)
        if len(ready) > 1 and self._random.random() < self._rate:
            self._lower(ready[place])
            place = self._highest(ready)
        return place

    def leaves(self, running: Hashable, ready: Sequence[Hashable], accesses: Accesses = NO_ACCESSES) -> bool:
        """Whether a thread of a higher priority could run, perhaps because of a change point here."""
        if self._random.random() < self._rate:
            self._lower(running)
        mine = self._priority(running)
        return any(self._priority(each) > mine for each in ready)

    def forget(self, thread: Hashable) -> None:
        """Drop its priority."""
        self._priorities.pop(thread, None)

    def _highest(self, ready: Sequence[Hashable]) -> int:
        return max(range(len(ready)), key=lambda place: self._priority(ready[place]))

    def _priority(self, thread: Hashable) -> float:
        known = self._priorities.get(thread)
        if known is None:
            known = self._priorities[thread] = self._random.random()
        return known

    def _lower(self, thread: Hashable) -> None:
        self._priorities[thread] = next(self._lowest)


class PartialOrderSampling(RandomWalk):
    """The choices of a seed: every step of a thread gets a random priority, and the highest goes on.

    A step that waits gets another one once a step is done that it conflicts with: both access the same data,
    and one of them writes it. So all orders of steps that conflict are about equally likely, however many
    steps there are that do not (Partial Order Aware Concurrency Sampling, 2018).
    """

    def __init__(self, seed: int) -> None:
        super().__init__(seed)
        self._priorities: dict[Hashable, float] = {}
        self._steps: dict[Hashable, Accesses] = {}

    def next(self, ready: Sequence[Hashable]) -> int:
        """The thread with the step of the highest priority."""
        place = max(range(len(ready)), key=lambda place: self._priority(ready[place]))
        self._take_step(ready[place])
        return place

    def leaves(self, running: Hashable, ready: Sequence[Hashable], accesses: Accesses = NO_ACCESSES) -> bool:
        """Whether a step of another thread has a higher priority than the next one of this."""
        self._steps[running] = accesses
        mine = self._priorities[running] = self._random.random()
        if any(self._priority(each) > mine for each in ready):
            return True
        self._take_step(running)
        return False

    def forget(self, thread: Hashable) -> None:
        """Drop its priority."""
        self._priorities.pop(thread, None)
        self._steps.pop(thread, None)

    def _priority(self, thread: Hashable) -> float:
        return self._priorities.setdefault(thread, self._random.random())

    def _take_step(self, thread: Hashable) -> None:
        self._priorities.pop(thread, None)
        done = self._steps.pop(thread, NO_ACCESSES)
        for other, accesses in self._steps.items():
            if any(name in accesses and (writes or accesses[name]) for name, writes in done.items()):
                self._priorities[other] = self._random.random()


STRATEGIES: dict[str, Callable[[int], Schedule]] = {
    "pos": PartialOrderSampling,
    "pct": Seeded,
    "random": RandomWalk,
}
"""How a seed makes its choices, by the name in front of it: ``pct:5``."""
USUAL = "pos"
"""The strategy of a seed without a name: most seeded bugs show soonest (``tests.exploring.strategies``)."""


def schedule_of(seed: Seed | None) -> Schedule:
    """The schedule of a seed; None and 0 mean first come, first served.

    ``moves:3=1`` plays moves, ``ask:3=1`` asks behind them, ``walk:5`` makes moves at random.
    """
    if not seed:
        return FirstCome()
    strategy, _, choices = str(seed).rpartition(":")
    if strategy in {"moves", "ask"}:
        return Played(moves_of(choices), asks=strategy == "ask")
    if strategy == "walk":
        return Walked(int(choices))
    return STRATEGIES[strategy or USUAL](int(choices))
