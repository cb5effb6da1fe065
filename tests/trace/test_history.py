"""A history answers like a sorted list, whatever of it is spilled."""

from bisect import insort_right
from operator import attrgetter

from hypothesis import given
from hypothesis import strategies as st

from sim.trace.events import CommandGiven
from sim.trace.model import Window
from sim.trace.storage.history import History
from sim.trace.storage.spill_file import SpillFile

times = st.integers(-20, 20)
items = st.lists(st.builds(CommandGiven, times, st.text(max_size=3)), max_size=60)
spills = st.builds(SpillFile, cache_size=st.integers(1, 400), entries=st.integers(1, 7))


class CountingSpillFile(SpillFile):
    """Counts the blocks that are stored."""

    count = 0

    def append(self, data: bytes) -> int:
        """Store and count a block."""
        self.count += 1
        return super().append(data)


def history_of(spill: SpillFile, items: list[CommandGiven]) -> History[CommandGiven]:
    history: History[CommandGiven] = History(attrgetter("t"), CommandGiven, spill)
    for item in items:
        history.add(item)
    return history


def in_order(items: list[CommandGiven]) -> list[CommandGiven]:
    naive: list[CommandGiven] = []
    for item in items:
        insort_right(naive, item, key=attrgetter("t"))
    return naive


@given(spills, items)
def test_items_stand_in_order_of_time_then_of_arrival(spill: SpillFile, items: list[CommandGiven]) -> None:
    history, naive = history_of(spill, items), in_order(items)
    assert len(history) == len(naive)
    assert history == naive
    assert [history[place] for place in range(-len(naive), len(naive))] == naive + naive
    assert list(reversed(history)) == naive[::-1]


@given(spills, items, st.slices(60))
def test_a_history_is_cut_like_a_list(spill: SpillFile, items: list[CommandGiven], cut: slice) -> None:
    assert history_of(spill, items)[cut] == in_order(items)[cut]


@given(spills, items, times, times)
def test_a_window_and_a_moment_are_found_by_time(
    spill: SpillFile, items: list[CommandGiven], start: int, end: int
) -> None:
    history, naive = history_of(spill, items), in_order(items)
    assert history.within(Window(start, end)) == [item for item in naive if start <= item.t < end]
    until = [item for item in naive if item.t <= start]
    assert history.until(start) == len(until)
    assert history.before(start) == len([item for item in naive if item.t < start])
    assert history.latest(start) == (until[-1] if until else None)


def test_many_that_come_very_late_do_not_each_have_everything_spilled_anew() -> None:
    spill = CountingSpillFile(cache_size=100, entries=4)
    early = [CommandGiven(at, "early") for at in range(400)]
    history = history_of(spill, [CommandGiven(at, "late") for at in range(400, 800)] + early)
    assert spill.count <= 400 // 4
    history.add(CommandGiven(800, "newest"))
    assert history == [*early, *(CommandGiven(at, "late") for at in range(400, 800)), history[-1]]
