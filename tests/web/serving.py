"""A server in a process of its own, and the processes that it started."""

import os
import subprocess
import sys
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager, contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

import aiohttp

from tests.support.processes import descendants


class Serving:
    """``cbtui serve`` at a free port.

    ``address`` is where, ``way_in`` the same with the token, ``home`` where it keeps things.
    """

    def __init__(self, process: "subprocess.Popen[str]", home: Path) -> None:
        self.process = process
        self.home = home
        assert process.stdout is not None
        self.first_line = process.stdout.readline()
        self.way_in = self.first_line.split()[4]
        self.address, _, self.token = self.way_in.partition("/?token=")

    def descendants(self) -> list[int]:
        """The numbers of all processes that it started, and that those started."""
        return descendants(self.process.pid)

    @asynccontextmanager
    async def visited(self) -> AsyncIterator[aiohttp.ClientSession]:
        """A visitor who has shown the token."""
        jar = aiohttp.CookieJar(unsafe=True)  # which takes those of numbers, as browsers do
        async with aiohttp.ClientSession(self.address, cookie_jar=jar) as session:
            async with session.get(self.way_in) as page:
                await page.read()
            yield session


@contextmanager
def serving(*words: str, **environment: str) -> Iterator[Serving]:
    """Serve, and end it."""
    command = [sys.executable, "-m", "cbtui", "serve", "--port", "0", *words]
    with (
        TemporaryDirectory() as home,
        subprocess.Popen(
            command, stdout=subprocess.PIPE, text=True, env=_environment(home) | environment
        ) as process,
    ):
        try:
            yield Serving(process, Path(home))
        finally:
            process.terminate()


def _environment(home: str) -> dict[str, str]:
    """Whoever runs the tests may have a configuration, and progress that is not to be touched."""
    folders = (f"XDG_{kind}_HOME" for kind in ("CONFIG", "DATA", "STATE", "CACHE"))
    return os.environ | {"HOME": home} | dict.fromkeys(folders, home)
