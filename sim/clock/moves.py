"""Schedules made of moves: the options chosen at the numbered choices of a run.

Threads switch only before the program's own steps: a line that touches shared data, a lock, a call of ROS in
a callback, the end of a callback. Choosing another thread than the running one is a preemption; where the
running thread waits, any thread that can run may continue.
"""

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass
from random import Random
from typing import TypeAlias
from zlib import crc32

from sim.clock.schedule import NO_ACCESSES, Accesses, Schedule

Moves: TypeAlias = Mapping[int, int]
"""The index of the chosen option by the number of the choice, from 0; elsewhere the first is chosen."""


@dataclass(frozen=True)
class Choice:
    """A choice among threads; the first one continues by default.

    ``preempts``: the first option is the running thread, and another option is a preemption. If the ``state``
    of two runs of a program is equal, all dependent steps so far came in the same order, and the same steps
    can follow.
    """

    number: int
    options: tuple[Hashable, ...]
    preempts: bool
    state: int


class MovesSchedule(Schedule):
    """Plays moves. ``decide`` may be replaced: it gets each choice and returns the index of an option."""

    explores = True

    def __init__(self, moves: Moves, *, asks: bool = False) -> None:
        self._moves = moves
        self.last_move = max(moves, default=-1)
        """The number of the last choice that has a move; -1 without moves."""
        self.asks = asks
        """Whether a person is asked at the choices after the last move."""
        self.decide: Callable[[Choice], int] = self.move_at
        self.now: Callable[[], int] = int
        """The time in nanoseconds, which is part of a state."""
        self._made = 0
        self._following: Hashable = None
        self._chosen: Hashable = None
        self._steps: dict[Hashable, Accesses] = {}
        self._numbers: dict[Hashable, int] = {}
        self._pasts: dict[int, int] = {}

    def move_at(self, choice: Choice) -> int:
        """The option that the moves name; the first if there is no such option."""
        move = self._moves.get(choice.number, 0)
        return move if move < len(choice.options) else 0

    def next(self, ready: Sequence[Hashable]) -> int:
        """The thread that the running one yielded to, or else a choice."""
        following, self._following = self._following, None
        place = self._choose(ready, preempts=False) if following is None else list(ready).index(following)
        self._chosen = ready[place]
        self._access(ready[place], self._steps.pop(ready[place], NO_ACCESSES))
        return place

    def yields(self, running: Hashable, ready: Sequence[Hashable], accesses: Accesses = NO_ACCESSES) -> bool:
        """A choice before each step of the program."""
        if not accesses:
            return False
        options = [running, *ready]
        # If it has done nothing since it was chosen, this would be the same choice.
        place = 0 if self._chosen is running else self._choose(options, preempts=True)
        if place:
            self._following = options[place]
            self._steps[running] = accesses
        else:
            self._access(running, accesses)
        return place > 0

    def hands_over(self) -> bool:
        """False: a thread that waits for a lock may continue next, or later."""
        return False

    def record_use(self, thread: Hashable, what: Hashable) -> None:
        """Make this step depend on all earlier uses of ``what``, and later uses on this step."""
        self._access(thread, {what: True})

    def _access(self, thread: Hashable, accesses: Accesses) -> None:
        me = self._number(thread)
        self._chosen = None if accesses else self._chosen
        for what, writes in accesses.items():
            data = self._number(what)
            past = hash((self._past(me), self._past(data), self._past(-data) if writes else 0, writes))
            if writes:
                self._pasts[data], self._pasts[-data] = past, 0
            else:
                self._pasts[-data] = self._past(-data) ^ past  # in any order
            self._pasts[me] = past

    def _choose(self, threads: Sequence[Hashable], *, preempts: bool) -> int:
        if len(threads) < 2:
            return 0
        options = tuple(threads)
        numbers = tuple(map(self._number, options))
        state = hash((self.now(), preempts, numbers, *sorted(self._pasts.items())))
        choice = Choice(self._made, options, preempts, state)
        self._made += 1
        return self.decide(choice)

    def _number(self, what: Hashable) -> int:
        """A number for a thread or for data; the negative number stands for the readers of the data."""
        if isinstance(what, str):
            return crc32(what.encode())
        return self._numbers.setdefault(what, len(self._numbers) + 1)

    def _past(self, number: int) -> int:
        """A hash of the steps that the latest step of a thread, or on data, depends on."""
        return self._pasts.get(number, number)


class RandomMovesSchedule(MovesSchedule):
    """Makes random moves, so that a list of moves can repeat the run."""

    _RATES = (0.5, 0.2, 0.05)
    """Probabilities of a preemption; the seed draws one of them for its run."""

    def __init__(self, seed: int) -> None:
        super().__init__({})
        self._random = Random(seed)
        self._rate = self._random.choice(self._RATES)
        self.decide = self._walk

    def _walk(self, choice: Choice) -> int:
        if choice.preempts and self._random.random() >= self._rate:
            return 0
        return self._random.randrange(len(choice.options))


def moves_of(seed: str) -> dict[int, int]:
    """Read the moves of a seed, with or without the strategy in front.

    Raises:
        ValueError: a move is not written as ``number=option``.
    """
    pairs = (each.partition("=") for each in seed.rpartition(":")[2].split(",") if each)
    return {int(number): int(option) for number, _, option in pairs}


def moves_text(moves: Moves, strategy: str = "moves") -> str:
    """The seed that plays moves, such as ``moves:3=1,9=2``."""
    return f"{strategy}:" + ",".join(f"{number}={option}" for number, option in sorted(moves.items()))
