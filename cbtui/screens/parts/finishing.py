"""Finishes files in the background, also while the screen is left."""

import asyncio
from collections.abc import Callable

from cbtui.runs.live.live_recording import FinishFile


class FileFinisher:
    """Finishes files on threads of their own; ``tell`` gets a sentence on each."""

    def __init__(self, tell: Callable[[str], None]) -> None:
        self.tell = tell
        self._tasks: set[asyncio.Task[None]] = set()

    def finish(self, finish: FinishFile | None) -> None:
        """Finish a file; does nothing for None."""
        if finish is not None:
            task = asyncio.create_task(self._finish(finish))
            self._tasks.add(task)
            task.add_done_callback(self._tasks.discard)

    async def wait(self) -> None:
        """Wait until every file is finished."""
        await asyncio.gather(*self._tasks)

    async def _finish(self, finish: FinishFile) -> None:
        sentence = await asyncio.to_thread(finish)
        self.tell(sentence)
