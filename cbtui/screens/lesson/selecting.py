"""Keys that select bars and lanes, and lead from findings, code and log to them."""

from textual import on

from cbtui.runs.live.findings import Told
from cbtui.screens.diagnoses import DiagnosesScreen
from cbtui.screens.lesson.timed import TimedScreen
from cbtui.widgets.code import CodeView
from cbtui.widgets.diagnosis_line import DiagnosisLine
from cbtui.widgets.lanes import Lanes, Selection, start_of
from cbtui.widgets.lanes.rows import all_lanes
from cbtui.widgets.lanes.selection import beside
from sim.trace.events import EntityId


class SelectingScreen(TimedScreen):
    """Knows what of a run is selected."""

    def action_select(self) -> None:
        """Go to the lanes, and select what is most worth a look if nothing is selected."""
        lanes = self.query_one(Lanes)
        lanes.focus()
        self._select(lanes.selection or lanes.here())

    def action_lane_above(self) -> None:
        """Select the lane above."""
        self._select(self.query_one(Lanes).lane_beside(-1))

    def action_lane_below(self) -> None:
        """Select the lane below."""
        self._select(self.query_one(Lanes).lane_beside(1))

    def action_previous_event(self) -> None:
        """Go back to the lane's bar before the cursor."""
        self._go_to_bar(self.query_one(Lanes).bar_beside(-1))

    def action_next_event(self) -> None:
        """Go on to the lane's next bar."""
        self._go_to_bar(self.query_one(Lanes).bar_beside(1))

    def action_deselect(self) -> None:
        """Leave the lanes."""
        self._select(None)
        self._show(self._pane)

    def action_to_code(self) -> None:
        """Show the code of the selected callback."""
        lanes = self.query_one(Lanes)
        callback = None if lanes.selection is None else lanes.selection.entity
        entity = None if callback is None else self._run.timeline.entities.get(callback)
        if entity is not None:
            self._show("code")
            self.query_one(CodeView).show_callback(entity)

    def _go_to_bar(self, found: Selection | None) -> None:
        if found is not None and found.bar is not None:
            self._select(found)
            self._move(self._playhead.sought(start_of(found.bar), self._run.timeline.end))

    def _select(self, selection: Selection | None) -> None:
        self.query_one(Lanes).selection = selection
        self._stale = True

    @on(Lanes.Picked)
    def _pick_bar(self, message: Lanes.Picked) -> None:
        self._select(message.selection)
        self._move(self._playhead.sought(message.at, self._run.timeline.end))

    def _last_of(self, entity: EntityId) -> Selection | None:
        """The lane of a callback, and the last bar on it up to the moment on screen."""
        timeline = self._run.timeline
        lanes = all_lanes(timeline, self._subject.service)
        lane = next((lane for lane in lanes if Selection(lane).entity == entity), None)
        if lane is None:
            return None
        after = min(self._playhead.now(timeline.end) + 1, timeline.end)
        return Selection(lane, beside(timeline, lane, after, -1))

    @on(CodeView.CallbackPicked)
    def _pick_callback(self, message: CodeView.CallbackPicked) -> None:
        lanes = self.query_one(Lanes)
        self._select(self._last_of(message.entity))
        if message.leaves:
            lanes.focus()

    def look_for_findings(self) -> None:
        """Have the rules look at the run now, not when their time has come."""
        self._watch.look()
        self._stale = True

    @on(DiagnosisLine.Clicked)
    def action_diagnoses(self) -> None:
        """List what the rules found."""
        self.look_for_findings()
        self.app.push_screen(DiagnosesScreen(self._watch.told, self._charset), self._go_to_finding)

    def _go_to_finding(self, told: Told | None) -> None:
        """Go to the moment and the code of a finding, and select the lane of what it happened to."""
        if told is None:
            return
        if told.at is not None:
            self._move(self._playhead.sought(told.at, self._run.timeline.end))
        self._select(self._last_of(told.finding.subject))
        if told.explanation.place is not None:
            self._show("code")
            self.query_one(CodeView).show_line(told.explanation.place.file, told.explanation.place.first_line)
