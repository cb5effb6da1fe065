"""A schedule that makes the first choices as it is told, then others, and tells which there were."""

from collections.abc import Callable, Hashable, Sequence
from random import Random
from typing import NamedTuple

from sim.clock.schedule import NO_ACCESSES, Accesses, Schedule


class Choice(NamedTuple):
    """A choice that was made behind so many lines of a program, among so many options."""

    line: int
    options: int
    chosen: int


class Steering(NamedTuple):
    """What is chosen first; then the seed chooses at random; without one, the first option is chosen."""

    chosen: Sequence[int] = ()
    seed: int | None = None


class Steered(Schedule):
    """Chooses as ``steering`` has it; ``line`` tells how many lines there are."""

    explores = True
    _RATES = (0.0, 0.02, 0.1, 0.4)
    """How often another option than the first one is chosen; the seed draws one for its run."""

    def __init__(self, steering: Steering, line: Callable[[], int]) -> None:
        self.made: list[Choice] = []
        self._told = steering.chosen
        self._random = Random(steering.seed)
        self._rate, leaving = (0.0, 0.0) if steering.seed is None else self._random.choices(self._RATES, k=2)
        self._rate_of_leaving = leaving / 4
        """A running thread is left seldom, for there are many places."""
        self._line = line
        self._following: Hashable = None

    def next(self, ready: Sequence[Hashable]) -> int:
        """The one for which the running thread was left, or else a choice."""
        following, self._following = self._following, None
        return self.choose(len(ready)) if following is None else list(ready).index(following)

    def yields(self, running: Hashable, ready: Sequence[Hashable], accesses: Accesses = NO_ACCESSES) -> bool:
        """A choice among going on and each of the others."""
        place = self._choose(1 + len(ready), self._rate_of_leaving)
        if place:
            self._following = ready[place - 1]
        return place > 0

    def choose(self, number: int) -> int:
        """A choice."""
        return self._choose(number, self._rate)

    def hands_over(self) -> bool:
        """A choice, too."""
        return self.choose(2) == 0

    def _choose(self, number: int, rate: float) -> int:
        if number < 2:
            return 0
        made = len(self.made)
        if made < len(self._told):
            chosen = min(self._told[made], number - 1)
        else:
            chosen = self._random.randrange(number) if self._random.random() < rate else 0
        self.made.append(Choice(self._line(), number, chosen))
        return chosen
