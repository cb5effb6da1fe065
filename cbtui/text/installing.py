"""The command that installs a package beside cbtui, wherever cbtui itself is installed."""

import shlex
import sys
from importlib.util import find_spec


def install_command(*words: str) -> str:
    """Return a line for a shell; ``words`` are packages and pip's options.

    ``uv tool`` and ``uv venv`` make environments without pip, into which ``uv pip`` installs from outside.
    """
    if find_spec("pip") is None:
        return shlex.join(["uv", "pip", "install", "--python", sys.executable, *words])
    return shlex.join([sys.executable, "-m", "pip", "install", *words])
