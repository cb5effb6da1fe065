"""The console of one visitor: a process that draws for a browser, ended with its process tree."""

import asyncio
import os
import signal
from asyncio.subprocess import PIPE, Process
from collections.abc import Sequence

from aiohttp import web
from textual_serve.app_service import AppService
from textual_serve.download_manager import DownloadManager

from cbtui.terminal.capabilities import BROWSER_DRIVER

_EXIT_TIMEOUT = 6.0
"""Seconds that a console has to exit, its program included."""
_FRAMES_A_SECOND = "30"
_MOST_COLUMNS, _MOST_ROWS = 500, 200


class Visitor(AppService):
    """Runs ``command`` (the words of a command line) for one WebSocket."""

    def __init__(
        self, command: Sequence[str], websocket: web.WebSocketResponse, downloads: DownloadManager
    ) -> None:
        super().__init__(
            " ".join(command),
            write_bytes=self._send_bytes,
            write_str=self._send_text,
            close=self._close,
            download_manager=downloads,
        )
        self._words = command
        self._websocket = websocket
        self._ending: asyncio.Task[None] | None = None

    async def set_terminal_size(self, width: int, height: int) -> None:
        """Send the console its size."""
        await super().set_terminal_size(*_sane(width, height))

    async def run(self) -> None:
        """Forward the console's output until it exits; then close the connection."""
        await super().run()
        await self._close()

    async def stop(self) -> None:
        """End the console's process group; it is killed after a timeout."""
        if self._ending is None:
            self._ending = asyncio.create_task(self._end())
        await asyncio.shield(self._ending)

    def _build_environment(self, width: int = 80, height: int = 24) -> dict[str, str]:
        columns, rows = _sane(width, height)
        environment = super()._build_environment(columns, rows)
        return environment | {"TEXTUAL_DRIVER": BROWSER_DRIVER, "TEXTUAL_FPS": _FRAMES_A_SECOND}

    async def _open_app_process(self, width: int = 80, height: int = 24) -> Process:
        # In a session of its own: Ctrl-C in the server's terminal does not reach it, and it can be killed.
        self._process = process = await asyncio.create_subprocess_exec(
            *self._words,
            stdin=PIPE,
            stdout=PIPE,
            stderr=PIPE,
            env=self._build_environment(width, height),
            start_new_session=True,
        )
        self._stdin = process.stdin
        return process

    async def _end(self) -> None:
        if self._process is None:
            return
        try:
            async with asyncio.timeout(_EXIT_TIMEOUT):
                await self._download_manager.cancel_app_downloads(app_service_id=self.app_service_id)
                await self.send_meta({"type": "quit"})
                await self._process.wait()
        except TimeoutError:
            pass
        finally:
            _kill_group(self._process.pid)
        await self._process.wait()
        if self._task is not None:
            await self._task

    async def _send_bytes(self, data: bytes) -> None:
        # After the visitor has left, the output must still be read, or the console would block.
        if not self._websocket.closed:
            try:
                await self._websocket.send_bytes(data)
            except ConnectionError:
                return

    async def _send_text(self, text: str) -> None:
        if not self._websocket.closed:
            await self._websocket.send_str(text)

    async def _close(self) -> None:
        await self._websocket.close()


def _kill_group(leader: int) -> None:
    try:
        os.killpg(leader, signal.SIGKILL)
    except ProcessLookupError:
        return


def _sane(width: int, height: int) -> tuple[int, int]:
    return min(max(1, int(width)), _MOST_COLUMNS), min(max(1, int(height)), _MOST_ROWS)
