"""A world for a test, in either physics, closed after it."""

from collections.abc import Callable, Iterator

import pytest

from sim.robot.arena import ARENA, Arena
from sim.robot.physics import PhysicsChoice
from sim.robot.world import World

MakeWorld = Callable[..., World]


@pytest.fixture(params=PhysicsChoice)
def physics(request: pytest.FixtureRequest) -> PhysicsChoice:
    if request.param is PhysicsChoice.PYBULLET:
        pytest.importorskip("pybullet")
    chosen: PhysicsChoice = request.param
    return chosen


@pytest.fixture
def make_world(physics: PhysicsChoice) -> Iterator[MakeWorld]:
    made: list[World] = []

    def make(arena: Arena = ARENA) -> World:
        made.append(World(arena, physics))
        return made[-1]

    yield make
    for each in made:
        each.close()


@pytest.fixture
def world(make_world: MakeWorld) -> World:
    return make_world()
