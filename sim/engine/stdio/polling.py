"""``select.poll`` and ``select.epoll`` for programs that poll the terminal of a run."""

import select
from collections.abc import Callable
from typing import Any

WaitForKeys = Callable[[Callable[[], Any], float | None], tuple[Any, bool]]


class Polling:
    """A polling object that handles the terminal itself, and other files by the system's object of ``make``.

    ``is_terminal`` returns whether a file is the terminal for the calling thread. ``wait`` waits for keys, at
    most some seconds or, for None, without a limit; it returns the result of its first argument for other
    files, and whether there are keys. ``per_second`` is the number of timeout units in a second.
    """

    def __init__(
        self,
        is_terminal: Callable[[Any], bool],
        wait: WaitForKeys,
        make: Callable[..., Any],
        per_second: float,
        *arguments: Any,
        **named: Any,
    ) -> None:
        self._is_terminal = is_terminal
        self._wait = wait
        self._others = make(*arguments, **named)
        self._per_second = per_second
        self._ours: dict[int, int] = {}
        self._has_others = False

    def register(self, file: Any, eventmask: int = select.POLLIN | select.POLLPRI | select.POLLOUT) -> None:
        """Watch a file."""
        if self._is_terminal(file):
            self._ours[_descriptor(file)] = eventmask
        else:
            self._others.register(file, eventmask)
            self._has_others = True

    def modify(self, file: Any, eventmask: int) -> None:
        """Change the events that are watched for a file."""
        if _descriptor(file) in self._ours:
            self._ours[_descriptor(file)] = eventmask
        else:
            self._others.modify(file, eventmask)

    def unregister(self, file: Any) -> None:
        """Stop watching a file."""
        if self._ours.pop(_descriptor(file), None) is None:
            self._others.unregister(file)

    def poll(self, timeout: float | None = None, *maxevents: int) -> list[tuple[int, int]]:
        """Wait for watched events; return descriptors and events."""
        read_from = [each for each, mask in self._ours.items() if mask & select.POLLIN]
        if not read_from:
            return list(self._others.poll(timeout, *maxevents))
        seconds = None if timeout is None or timeout < 0 else timeout / self._per_second
        found, typed = self._wait(self._look, seconds)
        return [*found, *((each, select.POLLIN) for each in read_from if typed)]

    def _look(self) -> list[tuple[int, int]]:
        return list(self._others.poll(0)) if self._has_others else []

    def __getattr__(self, name: str) -> Any:
        return getattr(self._others, name)

    def __enter__(self) -> "Polling":
        return self

    def __exit__(self, *_error: object) -> None:
        self._others.close()


def _descriptor(file: Any) -> int:
    return file if isinstance(file, int) else file.fileno()
