"""The signs in the margin of the source; those of waits are the hatches of the lanes."""

from typing import NamedTuple


class CodeSigns(NamedTuple):
    """What stands beside a line."""

    here: str
    calls: str
    runs: str
    ran: str
    fault: str


CODE_SIGNS = CodeSigns(here="▶", calls="▸", runs="▌", ran="·", fault="✗")
"""Where only ASCII is shown, the filter replaces them."""
