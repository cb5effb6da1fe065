"""The memory limit of an engine's process tree."""

import os

MEMORY_LIMIT = "CBTUI_MEMORY_GB"
"""The environment variable with the limit in GB."""
GB = 1_000_000_000

_DEFAULT_LIMIT = 4 * GB


class BadMemoryLimitError(Exception):
    """The memory limit in the environment is not a positive number; the text is a sentence."""


def memory_limit() -> int:
    """The limit in bytes: from the environment, else 4 GB or half of the machine's memory.

    Raises:
        BadMemoryLimitError: the environment holds no positive number.
    """
    text = os.environ.get(MEMORY_LIMIT)
    if text is None:
        return min(_DEFAULT_LIMIT, os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") // 2)
    try:
        gigabytes = float(text)
    except ValueError:
        gigabytes = 0.0
    if not 0 < gigabytes < 1e6:
        raise BadMemoryLimitError(
            f"{MEMORY_LIMIT} has to be a number of GB above 0, such as 4, and is {text!r}"
        )
    return int(gigabytes * GB)
