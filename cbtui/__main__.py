"""``python -m cbtui`` and the ``cbtui`` command: Ctrl-C exits with status 130 and prints nothing."""

import gc
import sys

_INTERRUPTED = 130
_GARBAGE_THRESHOLD = 100_000
"""New objects that cause a garbage collection; with Python's own 700 the menu appears 15 ms later."""


def command() -> int:
    """Carry out the command line of this process; returns the exit code."""
    if sys.platform == "win32":
        sys.exit("cbtui: Windows lacks the signals and terminals that runs need; use WSL: wsl --install")
    gc.set_threshold(_GARBAGE_THRESHOLD)
    try:
        from cbtui.terminal import interrupts

        interrupts.install()
        from cbtui.cli import main

        try:
            return main()
        finally:
            interrupts.ignore()
    except ImportError as error:
        from cbtui.text.clashing_packages import on_hidden

        if not (clash := on_hidden(error)):
            raise
        sys.exit(f"cbtui: {clash}")
    except KeyboardInterrupt:
        return _INTERRUPTED


if __name__ == "__main__":
    sys.exit(command())
