"""A schedule that makes the first choices as it is told, then others, and tells which there were."""

from collections import deque
from collections.abc import Callable, Hashable, Sequence
from random import Random
from typing import NamedTuple

from sim.clock import VirtualClock
from sim.clock.schedule import NO_ACCESSES, Accesses, Schedule


class Choice(NamedTuple):
    """A choice that was made behind so many lines of a program, among so many options."""

    line: int
    options: int
    chosen: int


class Steering(NamedTuple):
    """What is chosen first; then the seed chooses at random; without one, the first option is chosen.

    ``wanted`` has the lines of each executor: a thread that would say another one than the next of these
    is left until it is the next one.
    """

    chosen: Sequence[int] = ()
    seed: int | None = None
    wanted: Sequence[Sequence[str]] = ()
    races: bool = False
    """Whether the threads of pools race."""
    stalls: Sequence[tuple[int, int]] = ()
    """Before which choices, and for how many nanoseconds, time passes although a thread could go on."""


class Steered(Schedule):
    """Chooses as ``steering`` has it; ``line`` tells how many lines there are."""

    explores = True
    _RATES = ((0.0, 0.1, 0.4, 0.8), (0.0, 0.02, 0.1, 0.3), (0.0, 0.2, 0.5, 0.8))
    """How often another option than the first one is chosen: of threads, of leaving the running one, and of
    others, such as what a wait ended with. The seed draws one of each for its run."""

    def __init__(self, steering: Steering, line: Callable[[], int]) -> None:
        self.made: list[Choice] = []
        self.stuck = False
        """Whether no thread can go on with a line that is wanted."""
        self._told = steering.chosen
        self._random = Random(steering.seed)
        drawn = [0.0 if steering.seed is None else self._random.choice(rates) for rates in self._RATES]
        self._rate_of_threads, self._rate_of_leaving, self._rate = drawn
        self._line = line
        self._following: Hashable = None
        self._races = steering.races
        self._stalls = deque(steering.stalls)
        self._wanted = [deque(lines) for lines in steering.wanted]
        self._about_to_say: dict[Hashable, str] = {}

    def says(self, clock: VirtualClock, line: str) -> None:
        """The running thread is about to say a line; it does once that is wanted, or the run is ``stuck``."""
        if not self._wanted:
            return
        thread = clock.current
        self._about_to_say[thread] = line
        clock.switch_point()
        if not self._goes_on(thread):
            self.stuck = True
            return
        del self._about_to_say[thread]
        next(lines for lines in self._wanted if lines and lines[0] == line).popleft()

    def _goes_on(self, thread: Hashable) -> bool:
        line = self._about_to_say.get(thread)
        return line is None or any(lines and lines[0] == line for lines in self._wanted)

    def next(self, ready: Sequence[Hashable]) -> int:
        """The one for which the running thread was left, or else a choice."""
        following, self._following = self._following, None
        if following is not None:
            return list(ready).index(following)
        able = [place for place, thread in enumerate(ready) if self._goes_on(thread)]
        return able[self._choose(len(able), self._rate_of_threads)] if able else 0

    def yields(self, running: Hashable, ready: Sequence[Hashable], accesses: Accesses = NO_ACCESSES) -> bool:
        """A choice among going on and each of the others."""
        able = [thread for thread in (running, *ready) if self._goes_on(thread)]
        if not able:
            return False
        rate = self._rate_of_leaving if able[0] is running else self._rate_of_threads
        following = able[self._choose(len(able), rate)]
        if following is running:
            return False
        self._following = following
        return True

    def choose(self, number: int) -> int:
        """A choice."""
        return self._choose(number, self._rate)

    def races(self) -> bool:
        """As the steering has it."""
        return self._races

    def stall(self) -> int:
        """As the steering has it."""
        if not self._stalls or self._stalls[0][0] > len(self.made):
            return 0
        return self._stalls.popleft()[1]

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
            other = self._random.random() < rate
            chosen = self._random.randrange(number) if other else 0
        self.made.append(Choice(self._line(), number, chosen))
        return chosen
