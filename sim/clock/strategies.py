"""Schedules that a seed names: four strategies of choosing threads, and schedules made of moves."""

from collections.abc import Callable, Hashable, Sequence
from itertools import count
from random import Random

from sim.clock.moves import MovesSchedule, RandomMovesSchedule, moves_of
from sim.clock.schedule import NO_ACCESSES, Accesses, Schedule, Seed


class RandomWalk(Schedule):
    """Every thread that can run is chosen with equal probability."""

    explores = True

    def __init__(self, seed: int) -> None:
        self._random = Random(seed)
        self._races = seed % 2 == 0

    def next(self, ready: Sequence[Hashable]) -> int:
        """The index of any thread."""
        return self.choose(len(ready))

    def yields(self, running: Hashable, ready: Sequence[Hashable], accesses: Accesses = NO_ACCESSES) -> bool:
        """Whether another thread can run: ``next`` then chooses among them all."""
        return len(ready) > 0

    def choose(self, number: int) -> int:
        """The index of any candidate."""
        return self._random.randrange(number) if number > 1 else 0

    def races(self) -> bool:
        """True for every second seed."""
        return self._races

    def hands_over(self) -> bool:
        """True with a probability of one half."""
        return self.choose(2) == 0


class BusyMachine(RandomWalk):
    """As `RandomWalk`, on a machine that is busy: one wait in four ends up to ``LATEST`` nanoseconds late.

    So a timer is called late, and a callback that sleeps takes longer. Where the threads of pools race, the
    machine also stalls at most ``MOST_STALLS`` times a run: for up to ``LONGEST_STALL`` nanoseconds, but at
    most to the next deadline, no thread goes on.
    """

    LATEST = 50_000_000
    LONGEST_STALL = 300_000_000
    """A log line in rclpy took so long at a load of 10."""
    MOST_STALLS = 3

    def __init__(self, seed: int) -> None:
        super().__init__(seed)
        number = self.MOST_STALLS if self._races else 0
        self._stalls = {int(10 ** self._random.uniform(1, 5)) for _ in range(number)}
        self._steps = 0

    def lateness(self) -> int:
        """Any time up to ``LATEST``, or mostly none."""
        return self.choose(self.LATEST) if self.choose(4) == 0 else 0

    def stall(self) -> int:
        """Any time up to ``LONGEST_STALL`` at few steps, early ones and late ones."""
        self._steps += 1
        return 1 + self.choose(self.LONGEST_STALL) if self._steps in self._stalls else 0


class PctSchedule(RandomWalk):
    """Every thread has a random priority, and the thread with the highest one runs.

    At each decision, with a probability that is drawn once a run, the thread that would run gets the lowest
    priority. So some seeds keep a thread slow for a long time, which independent draws would not do, and
    others switch all the time.

    This is probabilistic concurrency testing (Burckhardt, Kothari, Musuvathi and Nagarakatte: A Randomized
    Scheduler with Probabilistic Guarantees of Finding Bugs, ASPLOS 2010). Its change points recur, since
    nodes run for ever.
    """

    _CHANGE_RATES = (0.5, 0.2, 0.05, 0.01)

    def __init__(self, seed: int) -> None:
        super().__init__(seed)
        self._rate = self._random.choice(self._CHANGE_RATES)
        self._priorities: dict[Hashable, float] = {}
        self._lowest = count(-1, -1)

    def next(self, ready: Sequence[Hashable]) -> int:
        """The index of the thread with the highest priority; at a change point, the second highest."""
        place = self._highest(ready)
        if len(ready) > 1 and self._random.random() < self._rate:
            self._lower(ready[place])
            place = self._highest(ready)
        return place

    def yields(self, running: Hashable, ready: Sequence[Hashable], accesses: Accesses = NO_ACCESSES) -> bool:
        """Whether a thread with a higher priority can run, perhaps because of a change point here."""
        if self._random.random() < self._rate:
            self._lower(running)
        mine = self._priority(running)
        return any(self._priority(each) > mine for each in ready)

    def forget(self, thread: Hashable) -> None:
        """Drop the priority of a thread that has ended."""
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
    """Every step of a thread has a random priority, and the thread with the highest one runs.

    A waiting step gets a new priority after a step that conflicts with it: both access the same data, and one
    of them writes it. So all orders of conflicting steps are about equally likely, however many other steps
    there are (Partial Order Aware Concurrency Sampling, 2018).
    """

    def __init__(self, seed: int) -> None:
        super().__init__(seed)
        self._priorities: dict[Hashable, float] = {}
        self._steps: dict[Hashable, Accesses] = {}

    def next(self, ready: Sequence[Hashable]) -> int:
        """The index of the thread whose step has the highest priority."""
        place = max(range(len(ready)), key=lambda place: self._priority(ready[place]))
        self._take_step(ready[place])
        return place

    def yields(self, running: Hashable, ready: Sequence[Hashable], accesses: Accesses = NO_ACCESSES) -> bool:
        """Whether a step of another thread has a higher priority than the running thread's next one."""
        self._steps[running] = accesses
        mine = self._priorities[running] = self._random.random()
        if any(self._priority(each) > mine for each in ready):
            return True
        self._take_step(running)
        return False

    def forget(self, thread: Hashable) -> None:
        """Drop the priority of a thread that has ended."""
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
    "pct": PctSchedule,
    "random": RandomWalk,
    "busy": BusyMachine,
}
"""The schedules by the name in front of a seed, such as ``pct:5``."""
DEFAULT_STRATEGY = "pos"
"""The strategy of a seed without a name. It alone finds every seeded bug (``tests.exploring.strategies``)."""


def schedule_of(seed: Seed | None) -> Schedule:
    """The schedule of a seed; None and 0 mean first come, first served.

    ``moves:3=1`` plays moves, ``ask:3=1`` plays moves and then asks, ``walk:5`` makes random moves.
    """
    if not seed:
        return Schedule()
    strategy, _, choices = str(seed).rpartition(":")
    if strategy in {"moves", "ask"}:
        return MovesSchedule(moves_of(choices), asks=strategy == "ask")
    if strategy == "walk":
        return RandomMovesSchedule(int(choices))
    return STRATEGIES[strategy or DEFAULT_STRATEGY](int(choices))
