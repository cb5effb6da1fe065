"""Who may talk to the server."""

import pytest

from cbtui.web.guard import HostGuard, is_loopback

HERE = "127.0.0.1:8000"


@pytest.mark.parametrize("host", [HERE, "localhost:8000", "192.168.1.5:8000", "[::1]:8000", "cbtui.example"])
def test_the_server_goes_by_its_own_names_and_by_numbers(host: str) -> None:
    guard = HostGuard("127.0.0.1", "https://cbtui.example")
    assert guard.objection({"Host": host}) is None


@pytest.mark.parametrize(
    "host", ["evil.example:8000", "127.0.0.1.evil.example", "", "[", "localhost.evil.example"]
)
def test_it_goes_by_no_other_name(host: str) -> None:
    objection = HostGuard("127.0.0.1", None).objection({"Host": host})
    assert objection is not None
    assert "--public-url" in objection


@pytest.mark.parametrize(
    ("origin", "may"),
    [
        ("http://127.0.0.1:8000", True),
        ("https://cbtui.example", True),
        ("http://evil.example", False),
        ("http://127.0.0.1:9999", False),
        ("null", False),
    ],
)
def test_only_its_own_pages_may_use_it(origin: str, may: bool) -> None:
    guard = HostGuard("127.0.0.1", "https://cbtui.example")
    assert (guard.objection({"Host": HERE, "Origin": origin}) is None) is may


@pytest.mark.parametrize(
    ("host", "only_here"),
    [("127.0.0.1", True), ("::1", True), ("localhost", True), ("0.0.0.0", False), ("192.168.1.5", False)],
)
def test_only_loopback_needs_no_warning(host: str, only_here: bool) -> None:
    assert is_loopback(host) is only_here
