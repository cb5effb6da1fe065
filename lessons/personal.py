"""The folders in which programs keep what is a person's own.

Where nobody knows the person's home, they begin with ``~`` and are not absolute; nothing is there, and
nothing can be written. So it is for a user number without a name, in a container without HOME.
"""

from collections.abc import Callable
from pathlib import Path


def state_folder() -> Path:
    """Where progress and what was opened lately are kept."""
    # Not needed by most commands, and slow to import.
    import platformdirs

    return _known_or("~/.local/state/cbtui", lambda: platformdirs.user_state_path("cbtui", appauthor=False))


def config_folder() -> Path:
    """Where the configuration is."""
    import platformdirs

    return _known_or("~/.config/cbtui", lambda: platformdirs.user_config_path("cbtui", appauthor=False))


def _known_or(otherwise: str, ask: Callable[[], Path]) -> Path:
    try:
        return ask()
    except RuntimeError:  # older versions return a path with ~ instead
        return Path(otherwise)
