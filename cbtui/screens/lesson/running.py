"""A screen with a run: it starts and ends engines, takes what they tell, and commands them."""

import asyncio
from typing import TYPE_CHECKING, cast

from textual import on
from textual.message import Message

from cbtui.actions import PANES
from cbtui.changes import Changes
from cbtui.compositing import SparingCompositor
from cbtui.contenders import Side
from cbtui.findings import Watch
from cbtui.live_run import Deliver, Ended, LiveRun, OpenSession
from cbtui.playhead import Playhead
from cbtui.record import CannotRecordError
from cbtui.screens.sized import SizedScreen
from cbtui.subject import Subject
from cbtui.theme import Charset
from lessons.lesson import Lesson
from sim.trace.concurrency import Concurrency
from sim.trace.events import AnyEvent

if TYPE_CHECKING:
    from cbtui.app import CbtuiApp


class RunningScreen(SizedScreen[None]):
    """Holds a run and the moment that is on screen. What draws it marks itself stale here.

    Events come from the session's thread as one message a batch, and only make the timeline longer.
    """

    def __init__(
        self,
        subject: Subject,
        open_session: OpenSession,
        charset: Charset,
        changes: Changes | None = None,
    ) -> None:
        super().__init__()
        self._compositor = SparingCompositor()
        self._subject = subject
        self._open_session = open_session
        self._charset = charset
        self._changes = changes or Changes()
        self._runs = 0
        self._playhead = Playhead()
        self._before: Side | None = None
        self._pane = PANES[0]
        self._stale = True
        self._grown = False
        self._frames = 0
        self._offered: tuple[object, ...] = ()
        self._begin(speed=1.0)

    class Delivered(Message):
        """A batch of events of the run with this number."""

        def __init__(self, run: int, events: list[AnyEvent]) -> None:
            super().__init__()
            self.run = run
            self.events = events

    class Over(Message):
        """The engine of the run with this number is gone; ``loss`` says how, if it should not be."""

        def __init__(self, run: int, loss: str | None) -> None:
            super().__init__()
            self.run = run
            self.loss = loss

    @property
    def lesson(self) -> Lesson | None:
        """The lesson that is run; None for a file."""
        return self._subject.lesson

    @property
    def live_run(self) -> LiveRun:
        """The run on screen."""
        return self._run

    async def on_unmount(self) -> None:
        """End the engine, whatever way the screen is left."""
        saved = await asyncio.to_thread(self._run.stop)
        if saved is not None:
            cast("CbtuiApp", self.app).tell_saved(saved)

    def _hand_over(self, message: Message) -> None:
        """Bring something from the session's thread to the screen's; one that is closing lets it drop."""
        self.post_message(message)

    @on(Delivered)
    def _take(self, message: Delivered) -> None:
        if message.run == self._runs:
            self._tell(self._run.take(message.events))
            self._grown = True

    @on(Over)
    def _note_the_end(self, message: Over) -> None:
        if message.run == self._runs:
            self._tell(self._run.over(message.loss))
            self._stale = True

    def _begin(self, speed: float | None) -> None:
        """Set up another run; what the engine of the one before still sends no longer counts."""
        self._runs += 1
        number = self._runs
        self._run = self._new_run(
            speed,
            lambda events: self._hand_over(self.Delivered(number, events)),
            lambda loss: self._hand_over(self.Over(number, loss)),
        )
        self._concurrency = Concurrency(self._run.timeline)
        self._watch = Watch(self._run.timeline)
        self._playhead = self._playhead.live()
        self._stale = True

    def _new_run(self, speed: float | None, deliver: Deliver, ended: Ended) -> LiveRun:
        """A run of what is on screen."""
        setup = self._changes.applied(self._subject.set_up(self._changes.threads, speed))
        return LiveRun(setup, self._open_session, deliver, ended)

    def _move(self, playhead: Playhead) -> None:
        self._playhead = playhead
        self._stale = True

    def _redraw(self) -> None:
        self._stale = True

    def _tell(self, sentence: str | None) -> None:
        """Say something that goes by."""
        if sentence is not None:
            self.notify(sentence, markup=False)

    def action_call_service(self) -> None:
        """Call the lesson's service with true."""
        self._run.call(True)

    def action_call_service_off(self) -> None:
        """Call the lesson's service with false."""
        self._run.call(False)

    def action_pause(self) -> None:
        """Stop time."""
        self._run.pause()
        self._stale = True

    def action_resume(self) -> None:
        """Let time go on."""
        self._run.resume()
        self._stale = True

    def action_reset_world(self) -> None:
        """Put the robot back to its start."""
        self._run.reset_world()

    def action_slower(self) -> None:
        """Let time pass more slowly."""
        self._run.change_speed(-1)
        self._stale = True

    def action_faster(self) -> None:
        """Let time pass faster."""
        self._run.change_speed(1)
        self._stale = True

    def action_record(self) -> None:
        """Begin a recording of this run, or end it."""
        if self._run.recorded is not None:
            self._tell(self._run.end_recording())
        else:
            try:
                self._tell(self._run.record())
            except CannotRecordError as error:
                self._tell(str(error))
        self._stale = True

    def action_next_lesson(self) -> None:
        """Open the next lesson."""
        if self._subject.following is not None:
            cast("CbtuiApp", self.app).open_lesson(self._subject.following)

    def action_leave(self) -> None:
        """Go back to the menu."""
        self.dismiss()
