"""The keys that lanes speak of."""

from typing import NamedTuple

from cbtui.actions import Scope
from cbtui.keymap import STANDARD, Keymap
from cbtui.theme import Charset


class LaneKeys(NamedTuple):
    """Keys as people write them: for calling the service, and to a lane's bar before and after."""

    call: str
    before: str
    after: str


def lane_keys(keymap: Keymap, scope: Scope, charset: Charset) -> LaneKeys:
    """Return the keys that are in force on a screen with lanes."""
    call = keymap.sign(Scope.LESSON, "call_service", charset)
    before, after = (keymap.sign(scope, action, charset) for action in ("previous_event", "next_event"))
    return LaneKeys(call, before, after)


USUAL_KEYS = lane_keys(STANDARD, Scope.LESSON, Charset.ASCII)
"""The registry's keys."""
