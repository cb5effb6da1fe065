"""Checks the Host and Origin headers of requests.

Without this check any page that a visitor has open could drive the console: browsers let every page open a
WebSocket to this machine, and DNS rebinding allows all other requests as well.
"""

import socket
from collections.abc import Mapping
from ipaddress import ip_address
from urllib.parse import urlsplit


class HostGuard:
    """Accepts requests for the server's own names. IP addresses pass: they cannot be rebound."""

    def __init__(self, host: str, public_url: str | None) -> None:
        public = urlsplit(public_url or "")
        self._public_origin = f"{public.scheme}://{public.netloc}"
        self._names = {"localhost", host.lower(), socket.gethostname().lower()}
        self._names |= {public.hostname} if public.hostname else set()

    def objection(self, headers: Mapping[str, str]) -> str | None:
        """Return why a request is refused, or None."""
        host = headers.get("Host", "")
        if not self._goes_by(host):
            return f"this server does not go by the name {host!r}; cbtui serve --public-url gives it another"
        origin = headers.get("Origin")
        if origin is not None and origin not in {f"http://{host}", f"https://{host}", self._public_origin}:
            return f"a page of {origin!r} may not use this server"
        return None

    def _goes_by(self, host: str) -> bool:
        try:
            name = urlsplit(f"//{host}").hostname or ""
        except ValueError:
            return False
        return name in self._names or is_number(name)


def is_number(host: str) -> bool:
    """Tell whether a host is an IP address rather than a name."""
    try:
        ip_address(host)
    except ValueError:
        return False
    return True


def is_loopback(host: str) -> bool:
    """Tell whether only this machine reaches a host."""
    return host == "localhost" or (is_number(host) and ip_address(host).is_loopback)
