"""The token that every request must carry: once in the address, from then on in a cookie.

Every local user can reach the port, and a console runs programs as the server's user.
"""

import hmac

from aiohttp import web

PARAMETER = "token"


class AccessToken:
    """Compares the token of a request with the server's."""

    def __init__(self, text: str) -> None:
        self._text = text
        # Browsers send cookies to every port of a host, so the cookie is not the token itself.
        self._cookie = hmac.new(text.encode(), b"cbtui cookie", "sha256").hexdigest()

    def in_address(self, request: web.Request) -> bool:
        """Tell whether the address carries the token."""
        return _same(request.query.get(PARAMETER, ""), self._text)

    def in_cookie(self, request: web.Request) -> bool:
        """Tell whether the cookie of an earlier request is there."""
        return _same(request.cookies.get(_cookie_name(request), ""), self._cookie)

    def redirect(self, request: web.Request, *, secure: bool) -> web.Response:
        """Set the cookie, and redirect to the address without the token."""
        address = request.rel_url.without_query_params(PARAMETER)
        response = web.Response(status=303, headers={"Location": str(address)})
        response.set_cookie(
            _cookie_name(request), self._cookie, httponly=True, samesite="Strict", secure=secure
        )
        return response


def _same(shown: str, wanted: str) -> bool:
    return hmac.compare_digest(shown.encode(errors="replace"), wanted.encode())


def _cookie_name(request: web.Request) -> str:
    """The cookie's name contains the port, as cookies are shared by the ports of a host."""
    return f"cbtui-{request.get_extra_info('sockname')[1]}"
