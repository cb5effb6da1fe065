"""Watches a file that editors save in place, by renaming, or by creating it again."""

import asyncio
from collections.abc import AsyncIterator
from pathlib import Path

from watchfiles import awatch

from sim.files.untrusted import MAX_PROGRAM_BYTES, read_bytes

CANNOT_WATCH = (OSError, RuntimeError)
"""Errors of a folder that cannot be watched."""

_DEBOUNCE_MS = 50
"""Milliseconds without a further change after which a save is complete."""
_POLL_MS = 1000
"""Milliseconds between two reads without a change report: some file systems send none."""
_SAVE_TIME = 0.3
"""Seconds for which a file may be missing or empty during a save."""


async def contents(path: Path) -> AsyncIterator[bytes | None]:
    """Yield a file's content after each change and each poll; None while it is missing.

    The same content may come twice. Ends only when its task is cancelled.

    Raises one of ``CANNOT_WATCH`` if polling fails as well.
    """
    folder = path.parent
    try:
        async for _ in _changes(folder, force_polling=None):
            yield await _settled(path)
    except CANNOT_WATCH:  # out of watches, or the file system has none
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
        return read_bytes(path, MAX_PROGRAM_BYTES)
    except OSError:
        return None
