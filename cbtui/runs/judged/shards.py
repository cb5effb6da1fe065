"""Files with parts of an exploration, as from the machines of a CI matrix, which can be merged."""

from collections.abc import Sequence
from operator import attrgetter
from pathlib import Path

import msgspec

from cbtui.runs.judged.bounded_search import Branch, of_all_parts
from cbtui.runs.judged.exploration_text import ReplayCommand, Shrunk
from cbtui.runs.judged.exploring import ScheduleResult
from sim.files.untrusted import read_bytes

_MOST_BYTES = 1 << 28


class BadShardError(Exception):
    """Files that cannot be merged, or a file that cannot be written; the text is a sentence."""


class Shard(msgspec.Struct, frozen=True, kw_only=True):
    """The results of some seeds; ``first`` and ``schedules`` are the seeds of the whole exploration.

    ``replays`` are the commands that repeat a schedule. A search with at most ``preemptions`` preemptions may
    have several ``parts``; the results are those of the parts that are ``done``. Of each seed, ``preempted``
    has the number of preemptions, and ``branches`` where the search could continue from it. ``shrunk`` is the
    simplest failing schedule found.
    """

    program: str
    replays: tuple[ReplayCommand, ...]
    first: int
    schedules: int
    strategy: str
    results: dict[str, ScheduleResult]
    preemptions: int | None = None
    parts: int = 1
    done: tuple[int, ...] = ()
    preempted: dict[str, int] = {}
    branches: dict[str, tuple[Branch, ...]] = {}
    shrunk: Shrunk | None = None

    @property
    def missing(self) -> str:
        """A clause on the seeds or parts of the exploration without a result here; "" if there are none."""
        if self.preemptions is not None:
            open_parts = [str(part) for part in range(1, self.parts + 1) if part not in self.done]
            return f"part {', '.join(open_parts)} of {self.parts}, run to its end, is" if open_parts else ""
        missing = self.schedules - len(self.results)
        return f"{missing} of {self.schedules} schedules are" if missing else ""

    def ranked(self) -> dict[str, ScheduleResult]:
        """The results, the simplest of a search first, others in the order of their seeds."""
        return {seed: self.results[seed] for seed in sorted(self.results, key=self._rank)}

    def _rank(self, seed: str) -> tuple[int, int, str]:
        if self.preemptions is None:
            return int(seed.rpartition(":")[2]), 0, seed
        return self.preempted[seed], seed.count("="), seed

    def write_to(self, path: Path) -> None:
        """Write the file.

        Raises:
            BadShardError: it cannot be written.
        """
        try:
            path.write_bytes(msgspec.json.format(msgspec.json.encode(self)))
        except OSError as error:
            raise BadShardError(f"{path} cannot be written: {error.strerror}") from None


def merged(paths: Sequence[Path]) -> Shard:
    """All results of some files; those of a seed that is in several are taken once.

    Of a search whose parts are all there, these are the results of a search in one part.

    Raises:
        BadShardError: a file cannot be read, or is of another exploration than the first.
    """
    first, *others = (_read(path) for path in paths)
    whole = first
    for path, other in zip(paths[1:], others, strict=True):
        if _common_fields(other) != _common_fields(first):
            raise BadShardError(
                f"{path} belongs to another exploration than {paths[0]}: other options or program"
            )
        whole = msgspec.structs.replace(
            whole,
            results={**whole.results, **other.results},
            done=(*whole.done, *other.done),
            preempted={**whole.preempted, **other.preempted},
            branches={**whole.branches, **other.branches},
            shrunk=_simpler(whole.shrunk, other.shrunk),
        )
    if whole.preemptions is None or whole.missing:
        return whole
    seeds = of_all_parts(whole.preemptions, whole.branches)
    return msgspec.structs.replace(whole, results={seed: whole.results[seed] for seed in seeds})


def _simpler(one: Shrunk | None, other: Shrunk | None) -> Shrunk | None:
    if one is None or other is None:
        return one or other
    return min(one, other, key=attrgetter("rank"))._replace(tried=one.tried + other.tried)


def _common_fields(shard: Shard) -> Shard:
    """The fields that are equal in all parts of an exploration."""
    return msgspec.structs.replace(shard, results={}, done=(), preempted={}, branches={}, shrunk=None)


def _read(path: Path) -> Shard:
    try:
        return msgspec.json.decode(read_bytes(path, _MOST_BYTES), type=Shard)
    except OSError as error:
        raise BadShardError(f"{path} cannot be read: {error.strerror}") from None
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        raise BadShardError(f"{path} is not part of an exploration: {error}") from None
