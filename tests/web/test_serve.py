"""The console over a WebSocket: one for each visitor, as many as there is room for, none left behind."""

import asyncio
import os
import signal
import socket
import sys

import aiohttp
import pytest

from cbtui import cli
from tests.support.processes import alive, command_line
from tests.web.serving import Serving, serving

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(sys.platform != "linux", reason="processes are looked up in /proc"),
]

Socket = aiohttp.ClientWebSocketResponse
_NOT_OURS = "that is not what the page sends"
ENGINE = "multiprocessing.spawn"
RUNNING = ("--", "split-groups", "--threads", "4")
"""A lesson that asks nothing before it runs, since it is not as it is written."""


async def read_until(websocket: Socket, text: str) -> None:
    """Read what is drawn until a text was among it."""
    drawn = b""
    # A console never stops drawing, so that waiting for each message alone would know no end.
    async with asyncio.timeout(60):
        while text.encode() not in drawn:
            message = await websocket.receive(timeout=60)
            assert message.type is aiohttp.WSMsgType.BINARY, f"{message} before {text!r} in {drawn[-2000:]!r}"
            drawn += message.data


async def until_gone(processes: list[int]) -> None:
    async with asyncio.timeout(60):
        while any(map(alive, processes)):
            await asyncio.sleep(0.05)


async def until_an_engine_runs(server: Serving) -> int:
    async with asyncio.timeout(60):
        while True:
            for process in server.descendants():
                if ENGINE in command_line(process):
                    return process
            await asyncio.sleep(0.05)


async def until_there_is_room(session: aiohttp.ClientSession) -> None:
    """Wait for the server, which learns a moment after everybody else that a console has ended."""
    async with asyncio.timeout(60):
        while True:
            async with session.get("/") as page:
                if page.status == 200:
                    return
            await asyncio.sleep(0.05)


async def test_a_visitor_sees_the_menu_opens_a_lesson_and_leaves() -> None:
    with serving() as server:
        async with server.visited() as session:
            async with session.ws_connect("/ws?width=140&height=40") as websocket:
                await read_until(websocket, "Split groups")
                await websocket.send_json(["stdin", "3\r"])
                await read_until(websocket, "What do you expect?")
                await websocket.send_json(["stdin", "\x1b"])
                await read_until(websocket, "3 Split groups")
                await until_an_engine_runs(server)
                theirs = server.descendants()
                await websocket.send_json(["stdin", "q"])
                await read_until(websocket, "Unit 5")
                await websocket.send_json(["stdin", "q"])
                while (message := await websocket.receive(timeout=60)).type is aiohttp.WSMsgType.BINARY:
                    pass
                assert message.type is aiohttp.WSMsgType.CLOSE
            await until_gone(theirs)


async def test_a_visitor_who_goes_takes_the_engine_along_and_makes_room() -> None:
    with serving("--visitors", "1", *RUNNING) as server:
        async with server.visited() as session:
            websocket = await session.ws_connect("/ws")
            await until_an_engine_runs(server)
            async with session.get("/") as page:
                assert page.status == 503
                assert "The only place is taken; come back when somebody has left." in await page.text()
            async with session.ws_connect("/ws") as refused:
                assert b"The only place is taken" in (await refused.receive(timeout=60)).data
                assert (await refused.receive(timeout=60)).type is aiohttp.WSMsgType.CLOSE
            theirs = server.descendants()
            await websocket.close()
            await until_gone(theirs)
            await until_there_is_room(session)


@pytest.mark.parametrize("by", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
async def test_nothing_is_left_when_the_server_ends(by: signal.Signals) -> None:
    with serving(*RUNNING) as server:
        async with server.visited() as session, session.ws_connect("/ws"):
            await until_an_engine_runs(server)
            theirs = server.descendants()
            server.process.send_signal(by)
            ended = await asyncio.to_thread(server.process.wait, 60)
        assert ended == (-by if by is signal.SIGKILL else 0)
        await until_gone(theirs)
        assert not [*server.home.rglob("fault.txt")]


async def test_a_console_that_hangs_is_killed_with_its_engine() -> None:
    with serving(*RUNNING) as server:
        async with server.visited() as session, session.ws_connect("/ws"):
            await until_an_engine_runs(server)
            theirs = server.descendants()
            os.kill(theirs[0], signal.SIGSTOP)
            server.process.send_signal(signal.SIGINT)
            assert await asyncio.to_thread(server.process.wait, 60) == 0
        await until_gone(theirs)


async def test_strange_pages_and_strange_messages_get_nowhere() -> None:
    with serving("--visitors", "20") as server:
        async with server.visited() as session:
            async with session.get("/", headers={"Host": "evil.example"}) as page:
                assert page.status == 403
            with pytest.raises(aiohttp.WSServerHandshakeError, match="403"):
                await session.ws_connect("/ws", headers={"Origin": "http://evil.example"})
            for message in (
                *(
                    "nonsense",
                    "{}",
                    "[]",
                    "[" * 100_000,
                    '["resize", 3]',
                    '["stdin", 3]',
                    '["stdin", "\\ud800"]',
                ),
                *('["resize", {"width": Infinity, "height": 1}]', '["resize", {"width": NaN, "height": 1}]'),
            ):
                async with session.ws_connect("/ws?width=99999999&height=x") as websocket:
                    await websocket.send_str(message)
                    while (answer := await websocket.receive(timeout=60)).type is aiohttp.WSMsgType.BINARY:
                        pass
                    assert (answer.type, answer.extra) == (aiohttp.WSMsgType.CLOSE, _NOT_OURS), message
            async with session.get("/") as page:
                assert page.status == 200


async def test_the_page_takes_nothing_from_elsewhere() -> None:
    with serving() as server:
        async with server.visited() as session, session.get("/") as page:
            text = await page.text()
            policy = page.headers["Content-Security-Policy"]
    assert text.count("://") == 1
    assert f'data-session-websocket-url="ws{server.address.removeprefix("http")}/ws"' in text
    assert "default-src 'self'" in policy


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--port", "70000"], "'70000' is not a port; give 0 to 65535"),
        (["--visitors", "0"], "'0' is not a number of visitors; give 1 or more"),
        (["--public-url", "example.org"], "'example.org' is not an address"),
        (["--token", "too-short"], "a token has 12 or more printable characters"),
        (["--token", "no\nlines in it"], "a token has 12 or more printable characters"),
        (["--host", "256.0.0.1"], "cannot be reached at 256.0.0.1"),
        (["--theme", "drak"], "there is no theme 'drak'; did you mean 'dark'?"),
        (["--", "split-group"], "the nearest is 'split-groups'"),
        (["--", "none.py"], "there is no file none.py"),
    ],
)
def test_what_cannot_be_served_is_refused_in_one_line(
    words: list[str], sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as ended:
        cli.main(["serve", *words])
    assert ended.value.code == 2
    said = capsys.readouterr().err.splitlines()[-1]
    assert sentence in said


def test_a_port_in_use_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        with pytest.raises(SystemExit) as ended:
            cli.main(["serve", "--port", str(port)])
    assert ended.value.code == 2
    assert capsys.readouterr().err == (
        f"cbtui: port {port} of 127.0.0.1 is in use; choose another with --port, or 0 for any that is free\n"
    )


def test_without_textual_serve_the_way_to_it_is_told(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("cbtui.commands.serve.find_spec", lambda name: None)
    with pytest.raises(SystemExit):
        cli.main(["serve"])
    assert "pip install 'cbtui[serve]'" in capsys.readouterr().err


def test_an_address_that_others_reach_is_warned_of(capsys: pytest.CaptureFixture[str]) -> None:
    # The port is taken for the sake of an end: the warning comes first.
    with socket.socket() as taken:
        taken.bind(("0.0.0.0", 0))
        taken.listen()
        with pytest.raises(SystemExit):
            cli.main(["serve", "--host", "0.0.0.0", "--port", str(taken.getsockname()[1])])
    assert (
        "whoever has the token and reaches 0.0.0.0 can run programs on this machine"
        in capsys.readouterr().err
    )
