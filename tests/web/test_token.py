"""Nothing is reached without the token, which is shown once and then kept in a cookie."""

import os
import subprocess
import sys
from collections.abc import Iterator

import aiohttp
import pytest

from cbtui.web.token import AccessToken
from tests.support.processes import command_line, descendants, environment, port_of
from tests.web.serving import Serving, serving

ROUTES = ("/", "/static/js/textual.js", "/static/", "/download/some-key", "/nothing-here", "/ws")
TOKEN = "of our class: äöü & more"


@pytest.fixture(scope="module")
def server() -> Iterator[Serving]:
    with serving() as one:
        yield one


@pytest.mark.parametrize("route", ROUTES)
@pytest.mark.parametrize("query", ["", "?token=", "?token=wrong", "?token=%ff%fe", "?token=%c3%a4"])
async def test_no_route_is_reached_without_the_token(server: Serving, route: str, query: str) -> None:
    async with aiohttp.ClientSession(server.address) as session:
        for method in ("GET", "HEAD", "POST", "OPTIONS"):
            async with session.request(method, route + query) as answer:
                assert answer.status == 403
                assert "Set-Cookie" not in answer.headers
        async with session.get(route + query) as answer:
            text = await answer.text()
    assert "the whole address that <b>cbtui serve</b> printed in its terminal" in text
    assert server.token not in text


async def test_no_console_is_started_for_a_web_socket_without_the_token(server: Serving) -> None:
    async with aiohttp.ClientSession(server.address) as session:
        for cookie in ("", f"cbtui-{server.address.rpartition(':')[2]}={server.token}"):
            with pytest.raises(aiohttp.WSServerHandshakeError, match="403"):
                await session.ws_connect("/ws", headers={"Cookie": cookie})
    assert descendants(server.process.pid) == []


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can be somebody else")
def test_another_user_of_the_machine_reaches_nothing(server: Serving) -> None:
    asks = (
        "import encodings.idna, os, sys, urllib.request, urllib.error\n"
        "os.setresuid(65534, 65534, 65534)\n"
        "for address in sys.argv[1:]:\n"
        "    try: print(urllib.request.urlopen(address).status)\n"
        "    except urllib.error.HTTPError as error: print(error.code)\n"
    )
    words = [sys.executable, "-c", asks, *(server.address + route for route in ROUTES)]
    asked = subprocess.run(words, stdout=subprocess.PIPE, text=True, check=True)
    assert asked.stdout.split() == ["403"] * len(ROUTES)


async def test_the_token_is_left_out_of_the_address_and_kept_in_a_cookie(server: Serving) -> None:
    jar = aiohttp.CookieJar(unsafe=True)
    async with aiohttp.ClientSession(server.address, cookie_jar=jar) as session:
        async with session.get(f"{server.way_in}&fontsize=20", allow_redirects=False) as shown:
            assert (shown.status, shown.headers["Location"]) == (303, "/?fontsize=20")
            assert shown.headers["Referrer-Policy"] == "no-referrer"
            cookie = shown.headers["Set-Cookie"]
        for route, status in (("/?fontsize=20", 200), ("/static/js/textual.js", 200), ("/nothing-here", 404)):
            async with session.get(route) as page:
                assert page.status == status
                assert page.headers["Referrer-Policy"] == "no-referrer"
                assert server.token not in await page.text()
    assert cookie.startswith(f"cbtui-{server.address.rpartition(':')[2]}=")
    assert {"HttpOnly", "SameSite=Strict"} <= set(cookie.split("; "))
    assert server.token not in cookie


@pytest.mark.slow
async def test_behind_https_the_cookie_is_for_https_alone() -> None:
    with serving("--public-url", "https://localhost/") as server:
        assert server.address == "https://localhost"
        way_in = server.way_in.replace(server.address, f"http://127.0.0.1:{port_of(server.process.pid)}")
        async with aiohttp.ClientSession() as session, session.get(way_in, allow_redirects=False) as shown:
            assert "Secure" in shown.headers["Set-Cookie"].split("; ")


async def test_who_follows_a_link_of_another_site_is_led_on_by_a_page_of_ours(server: Serving) -> None:
    async with aiohttp.ClientSession(server.address) as session:
        for site, led_on in (("cross-site", "0; url=/"), ("same-origin", None), ("none", None)):
            async with session.get("/", headers={"Sec-Fetch-Site": site}) as refused:
                assert (refused.status, refused.headers.get("Refresh")) == (403, led_on)


@pytest.mark.slow
async def test_a_token_of_ones_own_is_neither_in_the_list_of_processes_nor_handed_to_programs() -> None:
    with serving("--", "split-groups", "--threads", "4", CBTUI_TOKEN=TOKEN) as server:
        async with server.visited() as session, session.ws_connect("/ws") as websocket:
            await websocket.receive(timeout=60)
            for process in (server.process.pid, *server.descendants()):
                assert "our class" not in command_line(process)
            for process in server.descendants():
                assert "our class" not in str(environment(process))


@pytest.mark.slow
def test_each_server_makes_a_token_of_its_own(server: Serving) -> None:
    with serving() as other:
        assert other.token != server.token
    assert len(server.token) >= 43


@pytest.mark.slow
def test_a_cookie_does_not_tell_the_token() -> None:
    assert TOKEN not in AccessToken(TOKEN)._cookie
