"""The user's folders for state and configuration.

If the home folder is unknown, as for a user id without a name in a container without HOME, the paths begin
with ``~`` and are not absolute: nothing exists there, and nothing can be written.
"""

from collections.abc import Callable
from pathlib import Path


def state_folder() -> Path:
    """Return the folder of the progress and of the recently opened entries."""
    # Slow to import, and most commands do not need it.
    import platformdirs

    return _known_or("~/.local/state/cbtui", lambda: platformdirs.user_state_path("cbtui", appauthor=False))


def config_folder() -> Path:
    """Return the folder of the configuration."""
    import platformdirs

    return _known_or("~/.config/cbtui", lambda: platformdirs.user_config_path("cbtui", appauthor=False))


def _known_or(otherwise: str, ask: Callable[[], Path]) -> Path:
    try:
        return ask()
    except RuntimeError:  # older versions return a path with ~ instead
        return Path(otherwise)
