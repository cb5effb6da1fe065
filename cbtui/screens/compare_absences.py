"""The keys that do nothing in a comparison say why."""

from collections.abc import Callable
from dataclasses import dataclass

from cbtui.keys.refused import NOT_IN_COMPARISON
from cbtui.screens.parts.part import ScreenPart


@dataclass
class ComparisonAbsences(ScreenPart):
    """Explains why a key does nothing; ``is_available`` tells whether an action does something now."""

    is_available: Callable[[str], bool | None]
    tell: Callable[[str], object]

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer the explanation where the action itself is not offered."""
        return not self.is_available(str(parameters[0]))

    def action_no_use(self, wanted: str) -> None:
        """Show the explanation."""
        self.tell(NOT_IN_COMPARISON[wanted][1])
