"""What the console sends to a terminal while a lesson runs: that must fit through ssh."""

from tests.benchmarks.console import lesson_opened


def sent(tenths: int, lesson: str = "split-groups") -> float:
    """The kB a second that the console sends in so many tenths of one, its lesson's service called."""
    with lesson_opened(lesson) as console:
        console.press("s")
        return console.watch(tenths / 10) / (tenths / 10) / 1e3
