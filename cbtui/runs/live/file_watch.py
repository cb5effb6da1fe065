"""Notices that a file was saved, however an editor does that: in place, by renaming, or by making it anew."""

import asyncio
from collections.abc import AsyncIterator
from pathlib import Path

from watchfiles import awatch

from sim.foreign_file import MOST_OF_A_PROGRAM, read_bytes

CANNOT_WATCH = (OSError, RuntimeError)
"""What is raised where a folder cannot be watched."""

_DEBOUNCE_MS = 50
"""Milliseconds without another change after which a save is over."""
_POLL_MS = 1000
"""Milliseconds after which the file is looked at in any case: some file systems do not report changes."""
_SAVE_TIME = 0.3
"""Seconds that a file may be gone or empty in the middle of a save."""


async def contents(path: Path) -> AsyncIterator[bytes | None]:
    """Yield what a file holds after each change, and as often as it is looked at; None while it is gone.

    The same may come twice. Ends only with the task that waits for it.

    Raises one of ``CANNOT_WATCH`` where nothing helps.
    """
    folder = path.parent
    try:
        async for _ in _changes(folder, force_polling=None):
            yield await _settled(path)
    except CANNOT_WATCH:  # the system watches no more files, or none of this kind
        async for _ in _changes(folder, force_polling=True):
            yield await _settled(path)


def _changes(folder: Path, force_polling: bool | None) -> AsyncIterator[object]:
    return awatch(
        folder,
        watch_filter=None,
        step=_DEBOUNCE_MS,
        rust_timeout=_POLL_MS,
        yield_on_timeout=True,
        force_polling=force_polling,
        recursive=False,
        ignore_permission_denied=True,
    )


async def _settled(path: Path) -> bytes | None:
    content = await asyncio.to_thread(content_of, path)
    if not content:
        await asyncio.sleep(_SAVE_TIME)
        content = await asyncio.to_thread(content_of, path)
    return content


def content_of(path: Path) -> bytes | None:
    """Return a file's content; None if it cannot be read."""
    try:
        return read_bytes(path, MOST_OF_A_PROGRAM)
    except OSError:
        return None
