"""Keys that move the cursor and the stretch of time on screen."""

from textual import on

from cbtui.screens.lesson.paned import PanedScreen
from cbtui.screens.moment import MomentScreen
from cbtui.widgets.lanes import Lanes
from cbtui.widgets.log import LogLines
from sim.trace.model import Nanoseconds


class TimedScreen(PanedScreen):
    """Moves through the time of a run."""

    def action_earlier(self) -> None:
        """Move the cursor back."""
        self._move(self._playhead.moved(-1, self._run.timeline.end))

    def action_later(self) -> None:
        """Move the cursor on."""
        self._move(self._playhead.moved(1, self._run.timeline.end))

    def action_step(self) -> None:
        """Go on by one scheduling decision, or to the next event of what was looked back to."""
        if self._playhead.at is None:
            self._run.step()
        else:
            self._move(self._playhead.beside(self._run.timeline, 1))

    def action_step_back(self) -> None:
        """Look at the event before."""
        self._move(self._playhead.beside(self._run.timeline, -1))

    def action_go_to_time(self) -> None:
        """Ask for a moment."""
        run = self._run
        end = run.timeline.end
        self.app.push_screen(
            MomentScreen(self._playhead.now(end), end, run.alive, self._charset), self._go_to_time
        )

    def _go_to_time(self, moment: Nanoseconds | None) -> None:
        """Look back at a moment that has passed; have the run go on to one that has not."""
        if moment is None:
            return
        end = self._run.timeline.end
        self._move(self._playhead.sought(moment, end))
        if moment > end and self._run.alive:
            self._run.run_until(moment)

    def action_live(self) -> None:
        """Go back to the present."""
        self._move(self._playhead.live())

    def action_zoom_in(self) -> None:
        """Show a shorter stretch of time."""
        self._move(self._playhead.zoomed(-1, self._run.timeline.end))

    def action_zoom_out(self) -> None:
        """Show a longer stretch of time."""
        self._move(self._playhead.zoomed(1, self._run.timeline.end))

    def action_pan_earlier(self) -> None:
        """Show an earlier stretch of time."""
        self._move(self._playhead.panned(-1, self._run.timeline.end))

    def action_pan_later(self) -> None:
        """Show a later stretch of time."""
        self._move(self._playhead.panned(1, self._run.timeline.end))

    @on(Lanes.Turned)
    def _turn(self, message: Lanes.Turned) -> None:
        self._move(self._playhead.zoomed(message.steps, self._run.timeline.end))

    @on(LogLines.MomentPicked)
    def _pick_moment(self, message: LogLines.MomentPicked) -> None:
        self._move(self._playhead.sought(message.at, self._run.timeline.end))
