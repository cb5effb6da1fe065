"""The keys that the lanes' hints name."""

from typing import NamedTuple

from cbtui.keys.action import Scope
from cbtui.keys.keymap import STANDARD, Keymap
from cbtui.looks.theme import Charset


class LaneKeys(NamedTuple):
    """Keys as people write them: for the service call, and for a lane's previous and next bar.

    ``more`` shows the hidden lanes. "" means that there is no such key.
    """

    call: str
    before: str
    after: str
    more: str = ""


def lane_keys(keymap: Keymap, scope: Scope, charset: Charset, *more: str) -> LaneKeys:
    """Return the current keys of a screen with lanes, where the actions ``more`` show hidden lanes."""
    call = keymap.sign(Scope.LESSON, "call_service", charset)
    before, after = (keymap.sign(scope, action, charset) for action in ("previous_event", "next_event"))
    return LaneKeys(call, before, after, " ".join(keymap.sign(scope, action, charset) for action in more))


USUAL_KEYS = lane_keys(STANDARD, Scope.LESSON, Charset.ASCII)
"""The registry's keys."""
