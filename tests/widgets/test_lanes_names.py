import pytest

from cbtui.widgets.lanes.names import thread_name
from sim.trace.model import Thread


@pytest.mark.parametrize(
    ("name", "room", "shown"),
    [
        ("MainThread", 11, "MainThread"),
        ("ThreadPoolExecutor-0_0", 22, "ThreadPoolExecutor-0_0"),
        ("ThreadPoolExecutor-0_0", 11, "Pool-0_0"),
        ("exercise53-1 ThreadPoolExecutor-0_0", 22, "exercise53-1 Pool-0_0"),
        ("exercise53-1 ThreadPoolExecutor-0_0", 18, "ex…se53-1 Pool-0_0"),
        ("exercise53-1 ThreadPoolExecutor-0_0", 11, "e…53-1 P0_0"),
        ("talker MainThread", 11, "talker Main"),
        ("exercise53-1 worker-thread-of-mine", 11, "exercise53-1 worker-thread-of-mine"),
    ],
)
def test_a_threads_name_gives_way_where_it_tells_least(name: str, room: int, shown: str) -> None:
    assert thread_name(Thread(1, name, 0), room, "…") == shown


def test_threads_of_programs_that_differ_at_the_end_stay_apart() -> None:
    names = {thread_name(Thread(1, f"exercise53-{n} MainThread", 0), 11, "…") for n in range(1, 4)}
    assert len(names) == 3
