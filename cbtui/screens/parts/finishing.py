"""Finishes files in the background, also while the screen is left."""

import asyncio
from collections.abc import Callable

from cbtui.runs.live.live_recording import FinishFile
from cbtui.terminal.background import BackgroundTasks


class FileFinisher:
    """Finishes files on threads of their own; ``tell`` gets a sentence on each."""

    def __init__(self, tell: Callable[[str], None]) -> None:
        self.tell = tell
        self._tasks = BackgroundTasks()

    def finish(self, finish: FinishFile | None) -> None:
        """Finish a file; does nothing for None."""
        if finish is not None:
            self._tasks.begin(self._finish(finish))

    async def wait(self) -> None:
        """Wait until every file is finished."""
        await self._tasks.wait()

    async def _finish(self, finish: FinishFile) -> None:
        sentence = await asyncio.to_thread(finish)
        self.tell(sentence)
