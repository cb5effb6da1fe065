"""The token that every request must show: once in the address, from then on in a cookie.

Every user of a machine can reach its ports, and a console can run programs as the server's user.
"""

import hmac

from aiohttp import web

PARAMETER = "token"


class AccessToken:
    """Compares what a request shows with the one token of a server."""

    def __init__(self, text: str) -> None:
        self._text = text
        # A browser sends cookies to every port of a host: what it keeps is not the token itself.
        self._cookie = hmac.new(text.encode(), b"cbtui cookie", "sha256").hexdigest()

    def in_address(self, request: web.Request) -> bool:
        """Tell whether the address ends in the token."""
        return _same(request.query.get(PARAMETER, ""), self._text)

    def in_cookie(self, request: web.Request) -> bool:
        """Tell whether the visitor has shown the token before."""
        return _same(request.cookies.get(_cookie_name(request), ""), self._cookie)

    def redirect(self, request: web.Request, *, secure: bool) -> web.Response:
        """Keep the visitor in mind by a cookie, and lead to the page by an address without the token."""
        address = request.rel_url.without_query_params(PARAMETER)
        response = web.Response(status=303, headers={"Location": str(address)})
        response.set_cookie(
            _cookie_name(request), self._cookie, httponly=True, samesite="Strict", secure=secure
        )
        return response


def _same(shown: str, wanted: str) -> bool:
    return hmac.compare_digest(shown.encode(errors="replace"), wanted.encode())


def _cookie_name(request: web.Request) -> str:
    """Several servers of one host have a cookie each."""
    return f"cbtui-{request.get_extra_info('sockname')[1]}"
