"""Keys that move the cursor and the window of time on screen."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from cbtui.runs.live.live_run import LiveRun
from cbtui.runs.live.playhead import SPANS, Playhead
from cbtui.screens.parts.part import ScreenPart, WindowHost
from cbtui.screens.windows.moment import MomentScreen
from sim.trace.model import Nanoseconds, Window
from sim.trace.timeline import Timeline


@dataclass
class TimeNavigation(ScreenPart):
    """Holds and moves the playhead of one or more runs.

    ``end`` returns the last moment, ``moved`` is called after each move, and ``live`` returns the run whose
    engine can run on, if there is one; ``stepped`` is called when the cursor goes to an event, and
    ``decisions`` returns how many are told at the moment on screen: steps go from each to the next.
    """

    timelines: Callable[[], Sequence[Timeline]]
    end: Callable[[], Nanoseconds]
    moved: Callable[[], None]
    live: Callable[[], LiveRun | None] = lambda: None
    stepped: Callable[[], None] = lambda: None
    decisions: Callable[[], int] = lambda: 1
    playhead: Playhead = field(default_factory=Playhead)
    place: int | None = None
    """Which decision of the moment on screen is looked at, from 0; None for the newest."""

    @property
    def now(self) -> Nanoseconds:
        """The moment on screen."""
        return self.playhead.now(self.end())

    @property
    def window(self) -> Window:
        """The window on screen."""
        return self.playhead.window(self.end())

    def move(self, playhead: Playhead) -> None:
        """Set the playhead."""
        self.place = self.place if playhead.at == self.playhead.at else None
        self.playhead = playhead
        self.moved()

    def seek(self, moment: Nanoseconds) -> None:
        """Put the cursor to a moment."""
        self.move(self.playhead.moved_to(moment, self.end()))

    def zoom(self, steps: int) -> None:
        """Show a longer (> 0) or shorter stretch of time."""
        self.move(self.playhead.zoomed(steps, self.end()))

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer the actions that would have an effect."""
        playhead, end = self.playhead, self.end()
        run = self.live()
        meaningless = {
            "pan_earlier": self.window.start == playhead.first,
            "pan_later": playhead.follows or self.window.end > end,
            "step": playhead.at is None and (run is None or not run.can_step),
            "step_back": self.now == playhead.first,
            "earlier": self.now == playhead.first,
            "live": playhead.follows or run is None or not run.alive,
            "to_end": playhead.follows or (run is not None and run.alive),
            "later": playhead.at is None,
            "zoom_in": playhead.span == SPANS[0],
            "zoom_out": playhead.span == SPANS[-1],
        }
        return not meaningless.get(action, False)

    def action_earlier(self) -> None:
        """Move the cursor back."""
        self.move(self.playhead.moved(-1, self.end()))

    def action_later(self) -> None:
        """Move the cursor on."""
        self.move(self.playhead.moved(1, self.end()))

    def action_step(self) -> None:
        """Run to the next scheduling decision, or, looking back, go to the next event."""
        run = self.live()
        if self.playhead.at is None and run is not None:
            run.step()
            self.stepped()
        else:
            self._go_to_event(1)

    def action_step_back(self) -> None:
        """Go to the previous event."""
        self._go_to_event(-1)

    def _go_to_event(self, step: int) -> None:
        here = self.decisions() - 1 if self.place is None else self.place
        place = here + step
        if self.playhead.at is None or not 0 <= place < self.decisions():
            run = self.live()
            stops = () if run is None else run.stops
            self.move(self.playhead.beside(self.timelines(), self.end(), step, stops))
            place = 0 if step > 0 else self.decisions() - 1
        self.place = None if self.playhead.at is None else place
        self.stepped()

    @property
    def run_that_goes_on(self) -> LiveRun | None:
        """Return the run whose engine can go on and pause at a moment, if there is one."""
        run = self.live()
        return run if run is not None and run.can_be_paced else None

    def go_to(self, moment: Nanoseconds) -> None:
        """Go to a past moment, or let the run continue to a future one."""
        is_to_come = moment > self.end()
        self.seek(moment)
        run = self.run_that_goes_on
        if is_to_come and run is not None:
            run.run_until(moment)

    def action_live(self) -> None:
        """Follow the end of the run."""
        self.move(self.playhead.live())

    def action_to_end(self) -> None:
        """Go to the end of what is over."""
        self.action_live()

    def action_zoom_in(self) -> None:
        """Show a shorter stretch of time."""
        self.zoom(-1)

    def action_zoom_out(self) -> None:
        """Show a longer stretch of time."""
        self.zoom(1)

    def action_pan_earlier(self) -> None:
        """Show an earlier stretch of time."""
        self.move(self.playhead.panned(-1, self.end()))

    def action_pan_later(self) -> None:
        """Show a later stretch of time."""
        self.move(self.playhead.panned(1, self.end()))


@dataclass
class MomentKey(ScreenPart):
    """Asks for a moment, and goes there."""

    host: WindowHost
    navigation: TimeNavigation

    def action_go_to_time(self) -> None:
        """Ask for a moment."""
        navigation = self.navigation
        goes_on = navigation.run_that_goes_on is not None
        question = MomentScreen(navigation.now, navigation.end(), goes_on, self.host.charset)
        self.host.ask(question, lambda moment: None if moment is None else navigation.go_to(moment))
