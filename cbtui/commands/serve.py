"""``cbtui serve``: the console in a browser."""

import argparse
import errno
import os
import sys
from importlib.util import find_spec
from urllib.parse import urlsplit

from cbtui.commands import console
from cbtui.commands.options import appearance
from cbtui.commands.options.command_parser import CommandParser
from cbtui.commands.options.targets import file_of, is_file_name, lesson_of, refuse
from cbtui.terminal.interrupts import deferred_interrupt
from cbtui.text.installing import install_command
from cbtui.text.output import CannotSayError, complain, is_text, say

_VISITORS = 8
_HIGHEST_PORT = 65535
_VARIABLE = "CBTUI_TOKEN"
_SHORTEST_TOKEN = 12


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument(
        "--host", type=_host, default="127.0.0.1", help="address to be reached at (%(default)s)"
    )
    parser.add_argument(
        "--port", type=_port, default=8000, help="port to be reached at, 0 for any that is free (%(default)s)"
    )
    parser.add_argument(
        "--visitors",
        metavar="N",
        type=_visitors,
        default=_VISITORS,
        help="how many can be there at a time (%(default)s)",
    )
    parser.add_argument(
        "--public-url",
        metavar="URL",
        type=_url,
        help="where visitors find it, when something stands in front of it (http://HOST:PORT)",
    )
    parser.add_argument(
        "--token",
        type=_token,
        default=os.environ.get(_VARIABLE) or None,
        help="what visitors have to show, instead of a new one each time; other users of this machine see it "
        f"in the list of processes, unless it is given in the variable {_VARIABLE}",
    )
    appearance.add_options(parser)


def serve(options: argparse.Namespace) -> int:
    """Serve until ctrl+c; returns the exit code."""
    if find_spec("textual_serve") is None:
        refuse(f"the browser needs textual-serve; install it with: {install_command('cbtui[serve]')}")
    appearance.appearance(options)
    command = [sys.executable, "-P", "-m", "cbtui", *appearance.given(options), *_opened(options.arguments)]
    import asyncio  # imported late, like the next two: no other command needs them
    import secrets

    from cbtui.web.guard import is_loopback
    from cbtui.web.server import ConsoleServer

    if not is_loopback(options.host):
        complain(
            f"whoever has the token and reaches {options.host} can run programs on this machine as you; "
            "give it only to people whom you trust, and not over a network on which others could read along"
        )
    os.environ.pop(_VARIABLE, None)  # programs of visitors must not see it
    token = options.token or secrets.token_urlsafe()
    server = ConsoleServer(command, options.host, options.port, options.visitors, options.public_url, token)
    try:
        with deferred_interrupt() as interruption:
            asyncio.run(server.serve_until_signal(_tell, interruption))
    except (BrokenPipeError, CannotSayError):
        raise  # warns about standard output, not about the address
    except (OSError, UnicodeError) as error:
        refuse(_why_not(error, options.host, options.port))
    return 0


def _tell(address: str) -> None:
    say(f"The console is at {address} (ctrl+c ends it)\n")


def _opened(words: list[str]) -> list[str]:
    """Return the rest of the visitors' command line; exits with code 2 and one line if it is wrong."""
    if not words:
        return []
    split = words.index("--") if "--" in words else len(words)
    parser = CommandParser(prog="cbtui open", add_help=False)
    console.add_open_options(parser)
    target = parser.parse_args(words[:split]).target
    if is_file_name(target):
        file_of(target)
    else:
        lesson_of(target, or_file=True)
    return ["open", *words]


def _why_not(error: OSError | UnicodeError, host: str, port: int) -> str:
    if isinstance(error, UnicodeError):
        return f"{host} is not an address; choose another with --host"
    if error.errno == errno.EADDRINUSE:
        return f"port {port} of {host} is in use; choose another with --port, or 0 for any that is free"
    if error.errno == errno.EACCES:
        return f"port {port} needs more rights than yours; choose one of 1024 or more with --port"
    return f"cannot be reached at {host}: {error.strerror or error}; choose another address with --host"


def _port(text: str) -> int:
    if not text.isdecimal() or int(text) > _HIGHEST_PORT:
        raise argparse.ArgumentTypeError(f"{text!r} is not a port; give 0 to {_HIGHEST_PORT}")
    return int(text)


def _token(text: str) -> str:
    if len(text) < _SHORTEST_TOKEN or not text.isprintable():
        # The token is not repeated: others may read the message.
        raise argparse.ArgumentTypeError(
            f"a token has {_SHORTEST_TOKEN} or more printable characters; give such a token with --token or "
            f"in {_VARIABLE}, or none at all for a random one"
        )
    return text


def _visitors(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number of visitors; give 1 or more")
    return int(text)


def _url(text: str) -> str:
    try:
        parts = urlsplit(text)
        well = parts.scheme in {"http", "https"} and parts.hostname and parts.port != 0
    except ValueError:  # a bad port, or a bad address in brackets
        well = False
    if not well:
        raise argparse.ArgumentTypeError(f"{text!r} is not an address; give one such as https://example.org")
    return text


def _host(text: str) -> str:
    if not (text and is_text(text)):
        raise argparse.ArgumentTypeError(f"{text!r} is not an address; give one such as 127.0.0.1")
    return text
