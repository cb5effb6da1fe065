"""``python -m sim.robot.probe`` builds the robot's world, and exits with 0 if that is possible.

The check is a process of its own because a broken PyBullet, which is C code, may crash.
"""

import sys

from sim.robot.bullet import WorldUnavailable
from sim.robot.world import World


def main() -> int:
    """Build a world; print one line on a failure, and return the exit code."""
    try:
        World().close()
    except WorldUnavailable as error:
        sys.stderr.write(f"{error.__cause__ or error}\n")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
