"""``python -m sim.robot.probe`` builds the robot's world, and ends with 0 if that is possible here.

A process of its own for those who want to know: PyBullet is C code, and a broken one may crash.
"""

import sys

from sim.robot.bullet import WorldUnavailable
from sim.robot.world import World


def main() -> int:
    """Build a world; returns the exit code, and says in one line what is wrong."""
    try:
        World().close()
    except WorldUnavailable as error:
        sys.stderr.write(f"{error.__cause__ or error}\n")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
