"""A headless Chromium with one page, driven over its DevTools protocol."""

import asyncio
import base64
import shutil
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from tempfile import TemporaryDirectory
from typing import Any

import aiohttp

PROGRAM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")

_QUIET = (
    *("--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"),
    *("--disable-background-networking", "--disable-component-update", "--disable-sync"),
    *("--remote-debugging-port=0", "--window-size=1400,800"),
)
_BINARY = 2


class Page:
    """What the page asked for (``requests``), what came over its WebSocket (``drawn``), and its keys."""

    def __init__(self, wire: aiohttp.ClientWebSocketResponse) -> None:
        self._wire = wire
        self._sent = 0
        self._answers: dict[int, asyncio.Future[dict[str, Any]]] = {}
        self.session: str | None = None
        self.requests: list[str] = []
        self.drawn = b""

    async def call(self, method: str, **parameters: object) -> dict[str, Any]:
        """Ask the browser to do something, and return its answer."""
        self._sent += 1
        message = {"id": self._sent, "method": method, "params": parameters}
        if self.session is not None:
            message["sessionId"] = self.session
        answer = self._answers[self._sent] = asyncio.get_running_loop().create_future()
        await self._wire.send_json(message)
        return await asyncio.wait_for(answer, 60)

    async def listen(self) -> None:
        """Take in what the browser tells, until it ends."""
        async for message in self._wire:
            told = message.json()
            parameters = told.get("params", {})
            match told.get("method"):
                case None:
                    self._answers.pop(told["id"]).set_result(told.get("result", {}))
                case "Network.requestWillBeSent":
                    self.requests.append(parameters["request"]["url"])
                case "Network.webSocketFrameReceived" if parameters["response"]["opcode"] == _BINARY:
                    self.drawn += base64.b64decode(parameters["response"]["payloadData"])

    async def press(self, key: str) -> None:
        """Press a key that types a character."""
        await self.call("Input.dispatchKeyEvent", type="keyDown", text=key, key=key)
        await self.call("Input.dispatchKeyEvent", type="keyUp", key=key)

    async def press_escape(self) -> None:
        """Press the key that types nothing and leads out."""
        key = {"key": "Escape", "code": "Escape", "windowsVirtualKeyCode": 27}
        await self.call("Input.dispatchKeyEvent", type="rawKeyDown", **key)
        await self.call("Input.dispatchKeyEvent", type="keyUp", **key)

    async def value_of(self, expression: str) -> Any:
        """Return what an expression is in the page."""
        answer = await self.call("Runtime.evaluate", expression=expression, returnByValue=True)
        return answer["result"].get("value")

    async def until_drawn(self, text: str) -> None:
        """Wait until a text was drawn since it was last waited for."""
        async with asyncio.timeout(60):
            while text.encode() not in self.drawn:
                await asyncio.sleep(0.05)
        self.drawn = self.drawn.partition(text.encode())[2]


@asynccontextmanager
async def page_of(address: str) -> AsyncIterator[Page]:
    """Open an address in a browser of its own."""
    assert PROGRAM is not None
    with TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        browser = await asyncio.create_subprocess_exec(
            PROGRAM,
            *_QUIET,
            f"--user-data-dir={profile}",
            "about:blank",
            stderr=asyncio.subprocess.PIPE,
            stdout=asyncio.subprocess.DEVNULL,
        )
        try:
            devtools = await asyncio.wait_for(_address_of(browser), 60)
            async with (
                aiohttp.ClientSession() as session,
                session.ws_connect(devtools, max_msg_size=0) as wire,
            ):
                page = Page(wire)
                listening = asyncio.create_task(page.listen())
                target = await page.call("Target.createTarget", url="about:blank")
                attached = await page.call("Target.attachToTarget", targetId=target["targetId"], flatten=True)
                page.session = attached["sessionId"]
                await page.call("Network.enable")
                await page.call("Page.enable")
                await page.call("Page.navigate", url=address)
                yield page
                listening.cancel()
        finally:
            browser.terminate()
            await browser.communicate()


async def _address_of(browser: asyncio.subprocess.Process) -> str:
    assert browser.stderr is not None
    async for line in browser.stderr:
        if b"DevTools listening on " in line:
            return line.decode().split()[-1]
    raise AssertionError("the browser did not start")
