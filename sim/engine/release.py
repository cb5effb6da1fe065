"""Which release of rclpy a run is like: the one its set-up names, else the first that a program asks for."""

import re
from collections.abc import Callable
from pathlib import Path

from sim.engine.setup import RunSetup
from sim.releases.distros import UnknownProfileError
from sim.releases.profile import Profile

_WISH = re.compile(r"^#\s*cbtui:\s*distro\s*=\s*(\S+)", re.MULTILINE)


def profile_of(setup: RunSetup, complain: Callable[[str], None]) -> Profile:
    """The profile of a run; a wish that cannot be had is told and passed over."""
    if setup.distro:
        return Profile.named(setup.distro)
    for program in setup.programs:
        try:
            wish = _WISH.search(Path(program.path).read_text(errors="replace"))
            if wish is not None:
                return Profile.named(wish[1])
        except UnknownProfileError as error:
            complain(f"{program.path}: {error}; the run is like {Profile()}")
        except OSError:
            pass  # who runs it will tell
    return Profile()
