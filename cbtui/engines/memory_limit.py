"""How much memory an engine may use."""

import os

MEMORY_LIMIT = "CBTUI_MEMORY_GB"
"""The environment variable that says how much memory a node and what it starts may use."""
GB = 1_000_000_000

_USUAL_LIMIT = 4 * GB


class BadMemoryLimitError(Exception):
    """The memory limit in the environment is not a positive number; the text is a sentence."""


def memory_limit() -> int:
    """Bytes that an engine and what it starts may use: from the environment, else 4 GB or half of all.

    Raises:
        BadMemoryLimitError: the environment holds something else than a number of GB.
    """
    text = os.environ.get(MEMORY_LIMIT)
    if text is None:
        return min(_USUAL_LIMIT, os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") // 2)
    try:
        gigabytes = float(text)
    except ValueError:
        gigabytes = 0.0
    if not 0 < gigabytes < 1e6:
        raise BadMemoryLimitError(
            f"{MEMORY_LIMIT} has to be a number of GB above 0, such as 4, and is {text!r}"
        )
    return int(gigabytes * GB)
