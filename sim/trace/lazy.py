"""A mapping and a sequence whose values are created on access."""

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from typing import TypeVar, overload

KeyT = TypeVar("KeyT")
ValueT = TypeVar("ValueT")


class LazyMapping(Mapping[KeyT, ValueT]):
    """Maps each of ``keys`` to ``make(key)``, computed on every access.

    The collection of keys may grow. As thread-safe as the function and the collection.
    """

    __slots__ = ("_keys", "_make")

    def __init__(self, keys: Collection[KeyT], make: Callable[[KeyT], ValueT]) -> None:
        self._keys = keys
        self._make = make

    def __getitem__(self, key: KeyT) -> ValueT:
        if key not in self._keys:
            raise KeyError(key)
        return self._make(key)

    def __iter__(self) -> Iterator[KeyT]:
        return iter(self._keys)

    def __len__(self) -> int:
        return len(self._keys)

    def __repr__(self) -> str:
        return repr(dict(self))


class ListLike(Sequence[ValueT]):
    """A sequence that is compared and printed like a list."""

    __slots__ = ()

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Sequence):
            return len(self) == len(other) and all(mine == its for mine, its in zip(self, other, strict=True))
        return NotImplemented

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return repr(list(self))


class LazySequence(ListLike[ValueT]):
    """The values of row numbers, each made by ``make`` on access.

    A picture of an hour of a run queries a hundred thousand calls and reads a few hundred.
    """

    __slots__ = ("_make", "_rows")

    def __init__(self, rows: Sequence[int], make: Callable[[int], ValueT]) -> None:
        self._rows = rows
        self._make = make

    def __len__(self) -> int:
        return len(self._rows)

    @overload
    def __getitem__(self, place: int) -> ValueT: ...
    @overload
    def __getitem__(self, place: slice) -> Sequence[ValueT]: ...
    def __getitem__(self, place: int | slice) -> ValueT | Sequence[ValueT]:
        if isinstance(place, slice):
            return LazySequence(self._rows[place], self._make)
        return self._make(self._rows[place])

    def __iter__(self) -> Iterator[ValueT]:
        return map(self._make, self._rows)
