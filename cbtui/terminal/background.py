"""Tasks in the background that somebody waits for at the end."""

import asyncio
from collections.abc import Coroutine


class BackgroundTasks:
    """Coroutines that run beside the caller. Used on one event loop."""

    def __init__(self) -> None:
        self._tasks: set[asyncio.Task[None]] = set()

    def begin(self, work: Coroutine[None, None, None]) -> None:
        """Run a coroutine as a task."""
        task = asyncio.create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._forget)

    async def wait(self) -> None:
        """Wait until every task is done; raises what the first that failed has raised."""
        await asyncio.gather(*self._tasks)

    def _forget(self, task: asyncio.Task[None]) -> None:
        if task.cancelled() or task.exception() is None:
            self._tasks.discard(task)
