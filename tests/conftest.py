"""What holds for every test: random examples are the same each time, so that a red run is red again."""

from collections.abc import Iterator

import pytest
from hypothesis import settings

settings.register_profile("same-each-time", derandomize=True, deadline=None, database=None)
settings.load_profile("same-each-time")


@pytest.fixture(scope="session", autouse=True)
def state_of_nobody(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Let a console remember what it opened in a folder of the tests', and not in the person's."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_STATE_HOME", str(tmp_path_factory.mktemp("state")))
        yield


def pytest_addoption(parser: pytest.Parser) -> None:
    """Let somebody who is going to look at them have the pictures of ``tests/app/goldens`` drawn anew."""
    parser.addoption(
        "--accept-pictures", action="store_true", help="draw tests/app/goldens anew; look at them"
    )
