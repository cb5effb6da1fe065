"""The web server: serves the page, and starts a console for each visitor up to a limit."""

import asyncio
from collections.abc import Awaitable, Callable, Sequence
from pathlib import Path
from urllib.parse import quote

import aiohttp_jinja2
from aiohttp import web
from textual_serve.app_service import AppService
from textual_serve.server import Server, to_int

from cbtui.terminal.interrupts import Interruption, ending_signals_on_loop
from cbtui.web.guard import HostGuard
from cbtui.web.token import PARAMETER, AccessToken
from cbtui.web.visitor import Visitor

_HEARTBEAT = 15.0
_MOST_A_MESSAGE = 1 << 20
_ONLY_OURS = (
    "default-src 'self'; style-src 'self' 'unsafe-inline'; script-src 'self' 'unsafe-inline'; "
    "img-src 'self' data:; font-src 'self' data:; connect-src 'self' ws: wss:; frame-ancestors 'none'"
)
"""The page loads nothing from other origins, and no other page may embed it."""
_HEADERS = {
    "Content-Security-Policy": _ONLY_OURS,
    "Referrer-Policy": "no-referrer",
    "Cache-Control": "no-store",
}

Handler = Callable[[web.Request], Awaitable[web.StreamResponse]]


class ConsoleServer(Server):
    """Serves ``command`` (the words of a command line) to at most ``most`` visitors at a time.

    Requests need ``token``. ``public_url`` is where visitors find the server when that is
    not ``host`` and ``port``.
    """

    def __init__(
        self, command: Sequence[str], host: str, port: int, most: int, public_url: str | None, token: str
    ) -> None:
        super().__init__(
            " ".join(command), host, port, title="cbtui", templates_path=Path(__file__).parent / "pages"
        )
        self._words = command
        self._most = most
        self._outside = public_url
        self._guard = HostGuard(host, public_url)
        self._token = AccessToken(token)
        self._query = f"/?{PARAMETER}={quote(token, safe='')}"
        self._visitors: set[Visitor] = set()

    async def serve_until_signal(self, ready: Callable[[str], None], interruption: Interruption) -> None:
        """Serve until a signal comes, then end all consoles; returns at once if Ctrl-C came before.

        ``ready`` gets the address with the token. Raises OSError if the address cannot be bound.
        """
        over = asyncio.Event()
        with ending_signals_on_loop(lambda _: over.set()):
            if not interruption.came:
                await self._serve_until(over, ready)

    async def _serve_until(self, over: asyncio.Event, ready: Callable[[str], None]) -> None:
        runner = web.AppRunner(await self._make_app(), access_log=None)
        await runner.setup()
        try:
            await web.TCPSite(runner, self.host, self.port).start()
            name = f"[{self.host}]" if ":" in self.host else self.host
            address = self._outside or f"http://{name}:{runner.addresses[0][1]}"
            ready(address.rstrip("/") + self._query)
            await over.wait()
        finally:
            await runner.cleanup()

    async def on_startup(self, app: web.Application) -> None:
        """Print nothing: the command reports the address."""

    async def on_shutdown(self, app: web.Application) -> None:
        """End the visitors' consoles."""
        await asyncio.gather(*(visitor.stop() for visitor in self._visitors))

    async def _make_app(self) -> web.Application:
        app = await super()._make_app()
        app.middlewares.append(self._let_in)
        app.on_response_prepare.append(_add_headers)
        return app

    @web.middleware
    async def _let_in(self, request: web.Request, handler: Handler) -> web.StreamResponse:
        objection = self._guard.objection(request.headers)
        if objection is not None:
            return web.Response(status=403, text=f"{objection}\n")
        shown = self._token.in_address(request)
        if shown and request.path == "/":
            return self._token.redirect(request, secure=(self._outside or "").startswith("https:"))
        if shown or self._token.in_cookie(request):
            return await handler(request)
        return _refusal(request)

    async def handle_index(self, request: web.Request) -> web.Response:
        """Serve the page."""
        page, status = ("full.html", 503) if self._full else ("console.html", 200)
        address = self._outside.rstrip("/") if self._outside else f"http://{request.host}"
        context = {
            "websocket": f"{address.replace('http', 'ws', 1)}/ws",
            "font_size": min(max(to_int(request.query.get("fontsize", "16"), 16), 6), 48),
            "sentence": self._no_room,
        }
        return aiohttp_jinja2.render_template(page, request, context, status=status)

    async def handle_websocket(self, request: web.Request) -> web.WebSocketResponse:
        """Run a console for a visitor until either side closes."""
        websocket = web.WebSocketResponse(heartbeat=_HEARTBEAT, max_msg_size=_MOST_A_MESSAGE)
        await websocket.prepare(request)
        if self._full:
            await websocket.send_bytes(f"\r\n {self._no_room}\r\n".encode())
            await websocket.close()
            return websocket
        visitor = Visitor(self._words, websocket, self.download_manager)
        self._visitors.add(visitor)
        try:
            await visitor.start(
                to_int(request.query.get("width", ""), 80), to_int(request.query.get("height", ""), 24)
            )
            await self._process_messages(websocket, visitor)
        finally:
            await visitor.stop()
            self._visitors.discard(visitor)
        return websocket

    async def _process_messages(self, websocket: web.WebSocketResponse, app_service: AppService) -> None:
        try:
            await super()._process_messages(websocket, app_service)
        except (
            AssertionError,
            ArithmeticError,
            AttributeError,
            LookupError,
            RecursionError,
            TypeError,
            ValueError,
        ):
            await websocket.close(message=b"that is not what the page sends")

    @property
    def _full(self) -> bool:
        return len(self._visitors) >= self._most

    @property
    def _no_room(self) -> str:
        places = "The only place is" if self._most == 1 else f"All {self._most} places are"
        return f"{places} taken; come back when somebody has left."


async def _add_headers(_request: web.Request, response: web.StreamResponse) -> None:
    response.headers.update(_HEADERS)


def _refusal(request: web.Request) -> web.Response:
    wrong = PARAMETER in request.query
    sentence = "That is not the token of this console." if wrong else "This console is opened with a token."
    response = aiohttp_jinja2.render_template("token.html", request, {"sentence": sentence}, status=403)
    if request.headers.get("Sec-Fetch-Site") == "cross-site":
        # A strict cookie is not sent with a link from another site, but with this page's refresh.
        response.headers["Refresh"] = "0; url=/"
    return response
