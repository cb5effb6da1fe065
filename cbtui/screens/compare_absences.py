"""The keys that do nothing in a comparison say why."""

from collections.abc import Callable
from dataclasses import dataclass

from cbtui.screens.parts.part import ScreenPart

_ELSEWHERE = {
    "select": "Code is shown beside a run: a comparison has only lanes and figures.",
    "diagnoses": "Diagnoses are listed in a run; what is gone or new is told at the top.",
}
_BEGINNING, _END = "This is the beginning of the runs.", "This is the end of the runs."
_SENTENCES = {
    **_ELSEWHERE,
    "previous_event": "No bar is earlier on this lane.",
    "next_event": "No bar is later on this lane.",
    "earlier": _BEGINNING,
    "pan_earlier": _BEGINNING,
    "step_back": _BEGINNING,
    "later": _END,
    "pan_later": _END,
    "step": _END,
    "zoom_in": "This is the shortest stretch.",
    "zoom_out": "This is the longest stretch.",
}


@dataclass
class ComparisonAbsences(ScreenPart):
    """Explains why a key does nothing; ``is_available`` tells whether an action does something now."""

    is_available: Callable[[str], bool | None]
    tell: Callable[[str], object]

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer the explanation where the action itself is not offered."""
        wanted = str(parameters[0])
        return wanted in _ELSEWHERE or not self.is_available(wanted)

    def action_no_use(self, wanted: str) -> None:
        """Show the explanation."""
        self.tell(_SENTENCES[wanted])
