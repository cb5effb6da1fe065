"""What some tests need of the machine's physics."""

from importlib.util import find_spec

import pytest

with_pybullet = pytest.mark.skipif(find_spec("pybullet") is None, reason="PyBullet has no wheels here")
"""For tests that draw the robot's world, as the camera does."""
