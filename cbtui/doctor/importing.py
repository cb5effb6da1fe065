"""Imports modules in a process of its own, as C code may crash, and reports on each.

A line for each: ``begin NAME`` before, ``well NAME`` or ``bad NAME: why`` after.
"""

import importlib
import sys
from collections.abc import Sequence


def main(names: Sequence[str]) -> None:
    """Import the modules, and report on each."""
    for name in names:
        _say(f"begin {name}")
        try:
            importlib.import_module(name)
        except Exception as error:  # noqa: BLE001 - whatever a broken package raises is what is looked for
            _say(f"bad {name}: {type(error).__name__}: {' '.join(str(error).split())}")
        else:
            _say(f"well {name}")


def _say(line: str) -> None:
    sys.stdout.write(f"{line}\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main(sys.argv[1:])
