"""The selection of a bar on a screen's lanes, and the keys that move it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from cbtui.screens.parts.navigation import TimeNavigation
from cbtui.screens.parts.part import ScreenPart
from cbtui.widgets.lanes import Lanes, Selection, start_of


@dataclass
class BarSelection(ScreenPart):
    """Selects one bar or lane on the screen's lanes; ``changed`` is called for a new selection.

    ``tell`` shows a sentence.
    """

    lanes: Callable[[], Sequence[Lanes]]
    navigation: TimeNavigation
    changed: Callable[[], object]
    tell: Callable[[str], object]

    @property
    def selection(self) -> Selection | None:
        """What is selected."""
        return self._chosen.selection

    @property
    def _chosen(self) -> Lanes:
        """The lanes with the selection; the first ones if there is none."""
        every = self.lanes()
        return next((lanes for lanes in every if lanes.selection is not None), every[0])

    def select(self, selection: Selection | None, on: Lanes | None = None) -> None:
        """Select something on the lanes ``on``, by default on the first ones; None selects nothing."""
        every = self.lanes()
        for lanes in every:
            lanes.selection = selection if lanes is (on or every[0]) else None
        self.changed()

    def pick(self, message: Lanes.BarPicked) -> None:
        """Select the clicked bar, and go to its moment."""
        self.select(message.selection, message.control)
        self.navigation.seek(message.at)

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer the way to a bar on the selected lane; without a selection, to any time before or after."""
        is_back = action == "previous_event"
        if self.selection is not None:
            return self._chosen.bar_beside(-1 if is_back else 1) is not None
        return self.navigation.now > 0 if is_back else self.navigation.now < self.navigation.end()

    def action_previous_event(self) -> None:
        """Go back to the lane's previous bar before the cursor."""
        self._go(-1)

    def action_next_event(self) -> None:
        """Go on to the lane's next bar."""
        self._go(1)

    def _go(self, step: int) -> None:
        lanes = self._chosen
        found = lanes.bar_beside(step)
        if found is not None and found.bar is not None:
            self.select(found, lanes)
            self.navigation.seek(start_of(found.bar))
        else:
            self.tell(f"There is no {'earlier' if step < 0 else 'later'} bar here.")
