"""The key that compares the run with the previous one."""

from dataclasses import dataclass

from cbtui.screens.compare import CompareScreen
from cbtui.screens.parts.part import ScreenPart, WindowHost
from cbtui.screens.parts.restarts import Restarts


@dataclass
class CompareKey(ScreenPart):
    """Compares the run with the previous one."""

    host: WindowHost
    restarts: Restarts

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer it from the second run on."""
        return self.restarts.both is not None

    def action_compare(self) -> None:
        """Open the comparison."""
        if self.restarts.both is not None:
            self.host.ask(CompareScreen(*self.restarts.both, self.host.charset), None)
