"""PyBullet kept in its place: silent, replaceable by a sentence, one client per world."""

import os
import subprocess
import sys
from contextlib import closing

import pytest

from sim.robot.bullet import BulletClient, WorldUnavailable, silence
from sim.robot.physics import PhysicsChoice
from sim.robot.world import World

pytest.importorskip("pybullet")

WHOLE_LIFE = """
from sim.robot.world import World
world = World()
world.command(0.2, 0.0)
world.advance_to(5_000_000_000)
world.scan(), world.touching(), world.reset(), world.set_motors(False)
world.advance_to(6_000_000_000)
World()
world.close()
"""


def test_nothing_that_pybullet_says_reaches_the_terminal() -> None:
    run = subprocess.run([sys.executable, "-c", WHOLE_LIFE], capture_output=True, check=True)
    assert (run.stdout, run.stderr) == (b"", b"")


def test_silence_ends_with_its_block(capfd: pytest.CaptureFixture[str]) -> None:
    os.write(1, b"before ")
    with silence():
        os.write(1, b"within ")
        os.write(2, b"within ")
    os.write(1, b"after")
    assert tuple(capfd.readouterr()) == ("before after", "")


def test_a_missing_pybullet_is_one_sentence_that_says_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pybullet", None)
    with pytest.raises(WorldUnavailable, match=r"^PyBullet cannot be imported.*--physics numpy"):
        World(physics=PhysicsChoice.PYBULLET)


def test_a_pybullet_without_a_free_client_is_one_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    import pybullet

    monkeypatch.setattr(pybullet, "connect", lambda mode: -1)
    with pytest.raises(WorldUnavailable, match="one more world"):
        World()


def test_a_closed_world_cannot_reach_its_successor() -> None:
    import pybullet

    old = World()
    old.close()
    with closing(World()) as successor:
        old.close()
        with pytest.raises(pybullet.error):
            old.pose()
        assert successor.pose().x == pytest.approx(0.0, abs=1e-6)


def test_a_client_hands_on_constants_and_binds_functions_to_itself() -> None:
    with closing(BulletClient()) as one, closing(BulletClient()) as other:
        one.createMultiBody(0, one.createCollisionShape(one.GEOM_PLANE))
        assert (one.getNumBodies(), other.getNumBodies()) == (1, 0)
