"""Keys and clicks that navigate between lanes, code and findings."""

from dataclasses import dataclass

from textual.screen import Screen

from cbtui.runs.live.findings import ExplainedFinding
from cbtui.runs.live.live_run import ShownRun
from cbtui.screens.diagnoses import DiagnosesScreen
from cbtui.screens.parts.bars import BarSelection
from cbtui.screens.parts.navigation import TimeNavigation
from cbtui.screens.parts.panes import PaneLayout
from cbtui.screens.parts.part import ScreenHost, ScreenPart
from cbtui.screens.parts.runs import RunController
from cbtui.widgets.code import CodeView
from cbtui.widgets.lanes import Lanes, Selection
from cbtui.widgets.lanes.rows import all_lanes
from cbtui.widgets.lanes.selection import neighbouring_bar
from sim.trace.events import EntityId


@dataclass
class LaneSelection(ScreenPart):
    """Moves the selection along the lanes of one run, and between lanes and code.

    ``service`` has a lane before its first call.
    """

    screen: Screen[None]
    host: ScreenHost
    runs: RunController[ShownRun]
    navigation: TimeNavigation
    bars: BarSelection
    panes: PaneLayout
    service: str

    @property
    def _lanes(self) -> Lanes:
        return self.screen.query_one(Lanes)

    @property
    def callback(self) -> EntityId | None:
        """The selected callback."""
        selection = self._lanes.selection
        return None if selection is None else selection.entity

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer the actions for the selection."""
        lanes = self._lanes
        match action:
            case "select":
                return not lanes.has_focus or lanes.selection is None
            case "to_code":
                return lanes.has_focus and self.callback is not None
            case "lane_above" | "lane_below":
                return lanes.has_focus
            case "deselect":
                return lanes.has_focus or lanes.selection is not None
        return True

    def action_select(self) -> None:
        """Focus the lanes, and select the most relevant bar if nothing is selected."""
        lanes = self._lanes
        lanes.focus()
        self.bars.select(lanes.selection or lanes.here())

    def action_lane_above(self) -> None:
        """Select the lane above."""
        self.bars.select(self._lanes.lane_beside(-1))

    def action_lane_below(self) -> None:
        """Select the lane below."""
        self.bars.select(self._lanes.lane_beside(1))

    def action_deselect(self) -> None:
        """Leave the lanes."""
        self.bars.select(None)
        self.panes.show(self.panes.current)

    def action_to_code(self) -> None:
        """Show the code of the selected callback."""
        callback = self.callback
        entity = None if callback is None else self.runs.timeline.entities.get(callback)
        if entity is not None:
            self.panes.show("code")
            self.screen.query_one(CodeView).show_callback(entity)

    def action_diagnoses(self) -> None:
        """List what the rules found."""
        monitor = self.runs.findings
        monitor.look()
        self.host.redraw()
        self.host.ask(DiagnosesScreen(monitor.findings, self.host.charset), self._go_to_finding)

    def _go_to_finding(self, told: ExplainedFinding | None) -> None:
        """Go to a finding's moment and code, and select its callback's lane."""
        if told is None:
            return
        if told.at is not None:
            self.navigation.seek(told.at)
        self.bars.select(self._last_of(told.finding.subject))
        place = told.explanation.place
        if place is not None:
            self.panes.show("code")
            self.screen.query_one(CodeView).show_line(place.file, place.first_line)

    def pick_callback(self, message: CodeView.CallbackPicked) -> None:
        """Select the callback whose code was picked."""
        self.bars.select(self._last_of(message.entity))
        if message.leaves:
            self._lanes.focus()

    def _last_of(self, entity: EntityId) -> Selection | None:
        """The lane of a callback, and its last bar up to the moment on screen."""
        timeline = self.runs.timeline
        lanes = all_lanes(timeline, self.service)
        lane = next((lane for lane in lanes if Selection(lane).entity == entity), None)
        if lane is None:
            return None
        after = min(self.navigation.now + 1, timeline.end)
        return Selection(lane, neighbouring_bar(timeline, lane, after, -1))
