"""A world for a test, closed after it."""

from collections.abc import Iterator

import pytest

from sim.robot.world import World


@pytest.fixture
def world() -> Iterator[World]:
    built = World()
    yield built
    built.close()
