"""A schedule that is played move by move: by a list of moves, or by whoever is asked at each choice.

Threads are left only in front of the program's own steps: a line that touches shared data, a lock, a call of
ROS in a callback, the callback's end. Where the running thread could go on, leaving it is a preemption; where
it waits, any thread that can run may go on.
"""

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass
from random import Random
from types import MappingProxyType
from typing import TypeAlias
from zlib import crc32

Accesses: TypeAlias = Mapping[Hashable, bool]
"""What a step of a thread touches that others may touch, each with whether it writes that."""
NO_ACCESSES: Accesses = MappingProxyType({})

Moves: TypeAlias = Mapping[int, int]
"""What is chosen at some choices, by their numbers from 0; at the others it is the first option."""


@dataclass(frozen=True)
class Choice:
    """A choice among threads, the first of which goes on if nobody wants otherwise.

    ``preempts``: the first is the one that runs, and to choose another is a preemption. Where the ``state``
    of two runs of a program is equal, the steps so far that depend on each other came in the same order, and
    what can follow is the same.
    """

    number: int
    options: tuple[Hashable, ...]
    preempts: bool
    state: int


class Played:
    """Plays moves. ``decide`` may be replaced: it gets each choice, and returns the index of an option."""

    explores = True

    def __init__(self, moves: Moves, *, asks: bool = False) -> None:
        self._moves = moves
        self.last_move = max(moves, default=-1)
        """The number of the last choice at which the moves want something."""
        self.asks = asks
        """Whether somebody is to be asked behind the last move."""
        self.decide: Callable[[Choice], int] = self.move_at
        self.now: Callable[[], int] = int
        """The time, which is part of a state."""
        self._made = 0
        self._following: Hashable = None
        self._chosen: Hashable = None
        self._steps: dict[Hashable, Accesses] = {}
        self._numbers: dict[Hashable, int] = {}
        self._pasts: dict[int, int] = {}

    def move_at(self, choice: Choice) -> int:
        """The option that the moves want; the first where they want one that there is not."""
        move = self._moves.get(choice.number, 0)
        return move if move < len(choice.options) else 0

    def next(self, ready: Sequence[Hashable]) -> int:
        """The one for which the running thread was left, or else a choice."""
        following, self._following = self._following, None
        place = self._choose(ready, preempts=False) if following is None else list(ready).index(following)
        self._chosen = ready[place]
        self._access(ready[place], self._steps.pop(ready[place], NO_ACCESSES))
        return place

    def leaves(self, running: Hashable, ready: Sequence[Hashable], accesses: Accesses = NO_ACCESSES) -> bool:
        """A choice in front of each step of the program."""
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

    def choose(self, number: int) -> int:
        """The first: they are alike, or the order in which they came was a choice itself."""
        return 0

    def hands_over(self) -> bool:
        """Never: who waits for a lock may go on next, or later."""
        return False

    def forget(self, thread: Hashable) -> None:
        """Nothing to do: what it did remains part of the state."""

    def did(self, thread: Hashable, what: Hashable) -> None:
        """Note that what it did depends on all that was done with ``what`` before, and later uses on it."""
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
        """A number for a thread or for data; its negative is for the threads that have read the data."""
        if isinstance(what, str):
            return crc32(what.encode())
        return self._numbers.setdefault(what, len(self._numbers) + 1)

    def _past(self, number: int) -> int:
        """A hash of the steps that the latest one of a thread, or with data, depends on."""
        return self._pasts.get(number, number)


class Walked(Played):
    """Chooses by a seed where moves are played, so that moves can play it again."""

    _RATES = (0.5, 0.2, 0.05)
    """How likely a thread is to be stopped that could go on; the seed draws one for its run."""

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
        ValueError: it is none.
    """
    pairs = (each.partition("=") for each in seed.rpartition(":")[2].split(",") if each)
    return {int(number): int(option) for number, _, option in pairs}


def moves_text(moves: Moves, strategy: str = "moves") -> str:
    """The seed of a schedule that plays moves, such as ``moves:3=1,9=2``."""
    return f"{strategy}:" + ",".join(f"{number}={option}" for number, option in sorted(moves.items()))
