"""A schedule that makes each choice as it is told, and tells which choices there were."""

from collections.abc import Callable, Hashable, Mapping, Sequence

from sim.clock.schedule import NO_ACCESSES, Accesses, Schedule


class Steered(Schedule):
    """First come, first served, but for some choices, by their numbers from 0."""

    explores = True

    def __init__(self, moves: Mapping[int, int], said: Callable[[], int]) -> None:
        self.options: list[tuple[int, int, bool]] = []
        """For each choice that there was: behind how many lines, among how many, whether to go on is one."""
        self._moves = moves
        self._said = said
        self._following: Hashable = None

    def next(self, ready: Sequence[Hashable]) -> int:
        """The one for which the running thread was left, or else a choice."""
        following, self._following = self._following, None
        return self.choose(len(ready)) if following is None else list(ready).index(following)

    def yields(self, running: Hashable, ready: Sequence[Hashable], accesses: Accesses = NO_ACCESSES) -> bool:
        """A choice among going on and each of the others."""
        place = self._choose(1 + len(ready), preempts=True)
        if place:
            self._following = ready[place - 1]
        return place > 0

    def choose(self, number: int) -> int:
        """The option that the moves want, if there is it; else the first."""
        return self._choose(number, preempts=False)

    def hands_over(self) -> bool:
        """A choice, too."""
        return self.choose(2) == 0

    def _choose(self, number: int, *, preempts: bool) -> int:
        if number < 2:
            return 0
        self.options.append((self._said(), number, preempts))
        move = self._moves.get(len(self.options) - 1, 0)
        return move if move < number else 0
