"""How the memory of a whole console grows while it shows a run: ``python -m tests.benchmarks.growing``.

The figure of the table lets half an hour of a lesson pass twenty times as fast; ``--speed 1`` takes as long.
"""

import argparse

from tests.benchmarks.console import lesson_opened

_SPEEDS = (1, 2, 5, 10, 20)
"""What pressing the key for a higher speed again and again comes to."""
_WARM = 300
"""Seconds of the run before the first measurement: by then caches are full."""
_SERVICE_EVERY = 60
"""Seconds of the run between two calls of the lesson's service."""
_MEGABYTE = 1_000_000


def added(seconds: int, lesson: str = "split-groups", speed: int = 20) -> float:
    """The megabytes that so many seconds of a run add to a console that draws it live and is warm."""
    start, *_, end = measured(seconds, lesson, speed)
    return end - start


def measured(seconds: int, lesson: str, speed: int) -> list[float]:
    """The console's megabytes when it is warm and after every minute of the run from then on."""
    with lesson_opened(lesson) as console:
        console.press("+" * _SPEEDS.index(speed))
        found = []
        for second in range(0, max(2 * _SERVICE_EVERY, seconds), _SERVICE_EVERY):
            console.press("s")
            console.watch(min(_SERVICE_EVERY, seconds) / speed)
            if second >= min(_WARM, seconds) - _SERVICE_EVERY:
                found.append(console.resident / _MEGABYTE)
    return found


def main() -> None:
    """Tell the memory minute by minute."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.growing", description=__doc__)
    parser.add_argument("--minutes", type=int, default=30, help="of the run (%(default)s)")
    parser.add_argument("--speed", type=int, choices=_SPEEDS, default=20, help="of the run (%(default)s)")
    parser.add_argument("--lesson", default="split-groups", help="the lesson's id (%(default)s)")
    options = parser.parse_args()
    found = measured(options.minutes * 60, options.lesson, options.speed)
    print(*(f"{megabytes:.1f}" for megabytes in found))
    print(f"{found[-1] - found[0]:+.1f} MB over {len(found) - 1} minutes")


if __name__ == "__main__":
    main()
