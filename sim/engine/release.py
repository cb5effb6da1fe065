"""The release of rclpy that a run models: that of its set-up, else the first that a program asks for."""

import re
from collections.abc import Callable
from pathlib import Path

from sim.engine.setup import RunSetup
from sim.releases.distros import UnknownProfileError
from sim.releases.profile import Profile

_WISH = re.compile(r"^#\s*cbtui:\s*distro\s*=\s*(\S+)", re.MULTILINE)


def profile_of(setup: RunSetup, complain: Callable[[str], None]) -> Profile:
    """Return the profile of a run; ``complain`` gets a sentence on an unknown release, which is ignored."""
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
            pass  # running the program reports it
    return Profile()
